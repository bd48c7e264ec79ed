# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import hfremesh as hf


@pytest.fixture
def loaded(tet):
    points, cells = tet
    return hf.Mesh(points, cells, regions=[7], triangles=[[0, 2, 1]], triangle_labels=[3],
                   point_fields={"u": np.arange(12.0).reshape(4, 3)}, cell_fields={"p": [2.5]})


def test_meshio_takes_and_gives_everything(loaded):
    meshio = pytest.importorskip("meshio")
    out = hf.to_meshio(loaded)
    assert isinstance(out, meshio.Mesh) and [b.type for b in out.cells] == ["tetra", "triangle"]
    assert out.cell_data["region"][1].tolist() == [3]
    back = hf.from_meshio(out)
    assert back.hash == loaded.hash
    np.testing.assert_array_equal(back.attachments["point_fields"]["u"], np.arange(12.0).reshape(4, 3))
    assert back.attachments["cell_fields"]["p"].tolist() == [2.5]


def test_meshio_blocks_are_put_together(tet):
    meshio = pytest.importorskip("meshio")
    points = [*tet[0], [1, 1, 1]]
    mesh = meshio.Mesh(points, [("tetra", [[0, 1, 2, 3]]), ("vertex", [[0]]), ("tetra", [[1, 2, 3, 4]])],
                       cell_data={"gmsh:physical": [[5], [0], [6]]})
    made = hf.from_meshio(mesh)
    assert made.n_cells == 2 and list(made.regions) == [5, 6]


def test_vectors_of_a_name_for_labels_stay_a_field(tet):
    meshio = pytest.importorskip("meshio")
    mesh = meshio.Mesh(tet[0], [("tetra", tet[1])], cell_data={"material": [np.zeros((1, 3), dtype=int)]})
    made = hf.from_meshio(mesh)
    assert list(made.regions) == [0] and made.attachments["cell_fields"]["material"].shape == (1, 3)


def test_a_field_that_is_called_as_regions_are_is_refused(tet):
    mesh = hf.Mesh(*tet, regions=[7], cell_fields={"region": [2.5]})
    pytest.importorskip("meshio")
    with pytest.raises(ValueError, match="called 'region'"):
        hf.to_meshio(mesh)
    pytest.importorskip("pyvista")
    with pytest.raises(ValueError, match="called 'region'"):
        hf.to_pyvista(mesh)


def test_meshio_without_tetrahedra_is_refused():
    meshio = pytest.importorskip("meshio")
    with pytest.raises(ValueError, match="no cells of type 'tetra' but triangle"):
        hf.from_meshio(meshio.Mesh(np.eye(3), [("triangle", [[0, 1, 2]])]))
    with pytest.raises(ValueError, match="two-dimensional"):
        hf.from_meshio(meshio.Mesh(np.eye(2), [("tetra", [[0, 1, 1, 0]])]))


def test_pyvista_takes_and_gives_everything(loaded):
    pyvista = pytest.importorskip("pyvista")
    grid = hf.to_pyvista(loaded)
    assert isinstance(grid, pyvista.UnstructuredGrid) and grid.n_cells == 1
    assert grid.cell_data["region"].tolist() == [7]
    back = hf.from_pyvista(grid)
    np.testing.assert_array_equal(back.points, loaded.points)
    np.testing.assert_array_equal(back.cells, loaded.cells)
    assert list(back.regions) == [7] and back.attachments["cell_fields"]["p"].tolist() == [2.5]


def test_pyvista_triangles_are_labelled_faces(tet):
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.UnstructuredGrid({10: np.array(tet[1]), 5: np.array([[0, 1, 2]])}, np.array(tet[0]))
    grid.cell_data["material"] = np.where(grid.celltypes == 10, 4, 9)
    made = hf.from_pyvista(grid)
    assert list(made.regions) == [4] and made.attachments["triangle_labels"].tolist() == [9]


def test_pyvista_cells_of_other_kinds_are_refused():
    pyvista = pytest.importorskip("pyvista")
    hexahedron = pyvista.UnstructuredGrid({12: np.arange(8)[None]}, np.random.default_rng(1).random((8, 3)))
    with pytest.raises(ValueError, match="cell 0 has VTK type 12"):
        hf.from_pyvista(hexahedron)


def test_pyvista_grids_have_an_accessor(cavity):
    pyvista = pytest.importorskip("pyvista")
    if not hasattr(pyvista, "register_dataset_accessor"):
        pytest.skip("this PyVista has no accessors")
    grid = hf.to_pyvista(cavity)
    better = grid.hfremesh.improve(min_dihedral=15)
    assert better.hfremesh.result.goal_reached and better.hfremesh.check()
    assert better.hfremesh.stats().inverted == 0 < grid.hfremesh.stats().inverted
    assert len(better.hfremesh.quality("mean-ratio")) == better.n_cells
