# SPDX-License-Identifier: BSD-3-Clause
import gc

import numpy as np
import pytest

import hfremesh as hf


def test_points_are_a_view_that_outlives_its_mesh():
    mesh = hf.generate.box((2, 2, 2))
    view, cells = mesh.points, mesh.cells
    assert view.shape == (27, 3) and not view.flags.owndata
    address = view.__array_interface__["data"][0]
    assert mesh.points.__array_interface__["data"][0] == address
    expected = view.copy()
    del mesh
    gc.collect()
    np.testing.assert_array_equal(view, expected)
    assert cells.max() == 26


def test_writing_points_moves_vertices():
    mesh = hf.generate.box((2, 2, 2))
    assert hf.stats(mesh).inverted == 0
    mesh.points[13] += [2.0, 0, 0]
    assert hf.stats(mesh).inverted > 0
    mesh.points[13, 1] = np.nan
    for door in (hf.stats, hf.improve):
        with pytest.raises(ValueError, match=r"points\[13, 1\] is nan"):
            door(mesh)


def test_cells_are_read_only(cavity):
    assert cavity.cells.shape == (cavity.n_cells, 4)
    with pytest.raises(ValueError):
        cavity.cells[0, 0] = 1


def test_walks_agree_with_the_arrays(cavity):
    cells = np.array(cavity.cells)
    for v in (0, 100, 500, cavity.n_vertices - 1):
        around = cavity.vertex_cells(v)
        assert sorted(around) == list(np.flatnonzero((cells == v).any(axis=1)))
        assert sorted(cavity.vertex_vertices(v)) == sorted(set(cells[around].ravel()) - {v})
    edges = cavity.edges
    assert len(edges) == cavity.n_edges
    for a, b in edges[:: len(edges) // 7]:
        ring = cavity.edge_cells((a, b))
        assert sorted(ring) == list(np.flatnonzero((cells == a).any(axis=1) & (cells == b).any(axis=1)))
        for c, d in zip(ring, ring[1:]):
            assert d in cavity.cell_cells(c)
    assert set(cavity.neighbors[7]) - {-1} == set(cavity.cell_cells(7))
    assert cavity.find_cell(cells[3][::-1]) == 3
    assert cavity.find_cell([0, 1, 2, cavity.n_vertices - 1]) is None


def test_boundary_faces_look_outwards(cavity):
    p = np.array(cavity.points)
    a, b, c = (p[cavity.boundary_faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert volume == pytest.approx(1.0)
    assert len(cavity.boundary_faces) == hf.stats(cavity).boundary_faces


def test_queries_refuse_what_is_not_there(cavity):
    n = cavity.n_vertices
    for v in (-1, n, 2**40):
        with pytest.raises(IndexError, match=f"vertex {v} is out of range: there are {n}"):
            cavity.vertex_cells(v)
    with pytest.raises(IndexError, match="cell -5"):
        cavity.cell_cells(-5)
    with pytest.raises(ValueError, match="no edge joins vertices 0 and"):
        cavity.edge_cells((0, n - 1))


def test_cells_the_other_way_round_are_turned_and_told(cavity):
    cells = np.array(cavity.cells)[:, [1, 0, 2, 3]]
    mesh = hf.Mesh(cavity.points, cells)
    assert mesh.flipped and len(mesh.reoriented) == 0
    one = np.array(cavity.cells)
    one[5] = one[5][[1, 0, 2, 3]]
    assert list(hf.Mesh(cavity.points, one).reoriented) == [5]


def test_what_hangs_on_a_mesh_comes_back(tet):
    points, cells = tet
    mesh = hf.Mesh(points, cells, regions=[7], triangles=[[0, 1, 2]], triangle_labels=[3], edges=[[0, 1]],
                   edge_labels=[4], vertex_labels=[0, 5, 0, 0], fixed_vertices=[2], names={(3, 7): "steel"},
                   point_fields={"u": np.arange(12.0).reshape(4, 3)}, cell_fields={"id": [11]})
    more = mesh.attachments
    assert list(mesh.regions) == [7]
    assert more["triangles"].tolist() == [[0, 1, 2]] and list(more["triangle_labels"]) == [3]
    assert more["edges"].tolist() == [[0, 1]] and list(more["edge_labels"]) == [4]
    assert list(more["vertex_labels"]) == [0, 5, 0, 0] and list(more["fixed_vertices"]) == [2]
    assert more["names"] == {(3, 7): "steel"}
    np.testing.assert_array_equal(more["point_fields"]["u"], np.arange(12.0).reshape(4, 3))
    assert more["cell_fields"]["id"].dtype == np.int64 and list(more["cell_fields"]["id"]) == [11]


def test_a_copy_is_independent(cavity):
    other = cavity.copy()
    other.points[:] += 1
    assert other.hash != cavity.hash
    assert repr(other) == f"<hfremesh.Mesh: {cavity.n_vertices} vertices, {cavity.n_cells} cells>"


def test_statistics_agree_with_numpy(cavity):
    p, c = np.array(cavity.points), np.array(cavity.cells)
    e = p[c[:, 1:]] - p[c[:, :1]]
    volumes = np.linalg.det(e) / 6
    s = hf.stats(cavity)
    assert s.cells == len(c) and s.vertices == len(p)
    assert s.volume == pytest.approx(volumes.sum()) and s.absolute_volume == pytest.approx(abs(volumes).sum())
    assert list(s.inverted_cells) == list(np.flatnonzero(volumes < 0))
    np.testing.assert_allclose(hf.quality(cavity, metric="volume"), volumes, atol=1e-15)
    angles = hf.min_dihedral(cavity)
    assert angles.shape == (len(c),) and angles.min() == s.min_dihedral == s.min_dihedrals.min
    assert s.worst_cell == angles.argmin()
    assert s.dihedral_histogram.sum() == 6 * (len(c) - s.inverted)
    counts, edges = hf.histogram(cavity, bins=10)
    assert counts.sum() == len(c) and len(edges) == 11
    assert s.min_dihedrals.percentiles[50] == np.sort(angles)[int(np.ceil(len(c) / 2)) - 1]


def test_every_metric_has_a_value_for_every_cell(cavity):
    assert len(hf.METRICS) == 9
    for metric in hf.METRICS:
        assert np.isfinite(hf.quality(cavity, metric=metric)).all()
    with pytest.raises(ValueError, match="no metric is called 'beauty'.*mean-ratio"):
        hf.quality(cavity, metric="beauty")


def test_regions_have_figures_of_their_own():
    mesh = hf.generate.box((4, 4, 4), regions=2)
    regions = hf.stats(mesh).regions
    assert [r.region for r in regions] == [1, 2]
    assert [r.volume for r in regions] == pytest.approx([0.5, 0.5])
    assert hf.stats(mesh).interface_faces == 32


def test_check_says_what_is_wrong(cavity):
    found = hf.check(cavity)
    assert not found and len(found.inverted) == hf.stats(cavity).inverted and found.overlap > 0
    assert hf.check(hf.generate.ball(3))
    touching = hf.check([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 2], [-1, 0, 1], [0, -1, 1]],
                        [[0, 1, 2, 3], [3, 4, 5, 6]])
    assert not touching.is_manifold and touching.rule == "kNonManifoldVertex" and touching.valid


def test_fields_are_any_mapping_with_names(tet):
    from types import MappingProxyType

    mesh = hf.Mesh(*tet, cell_fields=MappingProxyType({"p": [2.5]}))
    assert mesh.attachments["cell_fields"]["p"].tolist() == [2.5]
    with pytest.raises(ValueError, match="cell_fields: the name 0 is no string"):
        hf.Mesh(*tet, cell_fields={0: [2.5]})
    with pytest.raises(ValueError, match="point_fields: a mapping"):
        hf.Mesh(*tet, point_fields=[1.0])
