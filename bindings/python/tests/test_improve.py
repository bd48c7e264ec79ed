# SPDX-License-Identifier: BSD-3-Clause
import inspect

import numpy as np
import pytest

import hfremesh as hf
from hfremesh import _core


def test_a_repair_reaches_its_goal_and_says_so(cavity):
    r = hf.improve(cavity.points, cavity.cells, min_dihedral=15)
    assert r.changed and r.goal_reached and r.stop == "goal" and not r.cancelled
    assert r.before.inverted == hf.stats(cavity).inverted and r.after.inverted == 0
    assert r.after.min_dihedral >= 15 and len(r.invalid_cells) == 0
    assert r.points.shape == (r.mesh.n_vertices, 3) and r.cells.shape == (r.mesh.n_cells, 4)
    assert hf.check(r.points, r.cells) and hf.stats(r.mesh).min_dihedral == r.after.min_dihedral


def test_a_good_mesh_is_unchanged():
    mesh = hf.generate.ball(4)
    r = hf.improve(mesh, min_dihedral=5)
    assert not r.changed and r.goal_reached and r.mesh.hash == mesh.hash


def test_maps_say_what_became_of_everything(cavity):
    r = hf.improve(cavity)
    maps = r.maps
    assert len(maps.vertices) == cavity.n_vertices and len(maps.cells) == cavity.n_cells
    assert len(maps.old_vertices) == r.mesh.n_vertices and len(maps.old_cells) == r.mesh.n_cells
    kept = np.flatnonzero(maps.vertices >= 0)
    np.testing.assert_array_equal(maps.old_vertices[maps.vertices[kept]], kept)
    same = np.flatnonzero(maps.old_cells >= 0)
    assert 0 < len(same) < r.mesh.n_cells
    old = np.sort(np.array(cavity.cells)[maps.old_cells[same]], axis=1)
    new = np.sort(maps.old_vertices[np.array(r.cells)[same]], axis=1)
    np.testing.assert_array_equal(old, new)
    assert len(hf.improve(cavity, maps=False).maps.vertices) == 0


def test_fields_hang_on_their_vertices_and_cells(cavity):
    n, m = cavity.n_vertices, cavity.n_cells
    given = {"T": np.arange(n, dtype=np.float32), "u": np.arange(3.0 * n).reshape(n, 3),
             "id": np.arange(m, dtype=np.int16), "stress": np.arange(6.0 * m).reshape(m, 6)}
    r = hf.improve(cavity.points, cavity.cells, fields=given, regions=np.full(m, 4))
    assert {k: (v.dtype, v.shape[1:]) for k, v in r.fields.items()} == {
        k: (v.dtype, v.shape[1:]) for k, v in given.items()}
    np.testing.assert_array_equal(r.point_fields["T"], given["T"][r.maps.sources])
    np.testing.assert_array_equal(r.point_fields["u"], given["u"][r.maps.sources])
    same = r.maps.old_cells >= 0
    np.testing.assert_array_equal(r.cell_fields["id"][same], given["id"][r.maps.old_cells[same]])
    assert (r.regions == 4).all() and set(r.cell_fields) == {"id", "stress"}


def test_fields_change_no_bit_of_the_mesh(cavity):
    plain = hf.improve(cavity, maps=False, statistics=False)
    loaded = hf.improve(cavity.points, cavity.cells, fields={"T": np.zeros(cavity.n_vertices)},
                        progress=lambda now: None)
    assert plain.mesh.hash == loaded.mesh.hash
    assert plain.before.cells == 0


def test_what_is_frozen_keeps_its_bits(cavity):
    surface = set(map(tuple, cavity.points[np.unique(cavity.boundary_faces)]))
    r = hf.improve(cavity)
    assert surface == set(map(tuple, r.points[np.unique(r.mesh.boundary_faces)]))
    inside = np.setdiff1d(np.arange(cavity.n_vertices), np.unique(cavity.boundary_faces))[:20]
    r = hf.improve(cavity.points, cavity.cells, fixed_vertices=inside)
    np.testing.assert_array_equal(r.points[r.maps.vertices[inside]], cavity.points[inside])


def test_a_surface_may_be_let_go():
    ball = hf.generate.cylinder((3, 8), twist=120, jitter=0.3)
    r = hf.improve(ball, surface="free", hausdorff=0.05)
    assert r.surface.bound == 0.05 and 0 < r.surface.hausdorff <= 0.05
    assert r.after.min_dihedral > hf.improve(ball).after.min_dihedral


def test_stuck_cells_say_why():
    wring = hf.generate.cylinder((3, 10), wring=70)
    r = hf.improve(wring, min_dihedral=30)
    assert not r.goal_reached and len(r.stuck) > 0 and r.stuck_below == 30
    cell = r.stuck[0]
    assert cell.degrees < 30 and isinstance(cell.reason, str) and cell.cell < r.mesh.n_cells
    assert any(s.is_proven for s in r.stuck)


def test_options_are_those_of_the_table():
    parameters = inspect.signature(hf.improve).parameters
    names = [name for name, *_ in _core.options()]
    assert len(names) == 25 and set(names) <= set(parameters)
    own = {"points", "cells", "regions", "fields", "point_fields", "cell_fields", "triangles", "triangle_labels",
           "fixed_vertices", "progress", "cancel", "statistics", "maps", "transfer"}
    assert set(parameters) == set(names) | own


def test_every_option_is_passed_on(cavity):
    with pytest.raises(TypeError):
        hf.improve(cavity, min_angle=20)
    for name, wanted, _, _ in _core.options():
        with pytest.raises(ValueError, match=f"^{name}: "):
            hf.improve(cavity, **{name: "no such thing"})
        with pytest.raises(ValueError, match=f"^{name}: "):
            hf.plan(cavity, **{name: "no such thing"})
    with pytest.raises(TypeError, match="no option is called 'min_angle'"):
        hf.plan(cavity, min_angle=20)


def test_values_reach_the_library_as_they_are(cavity):
    third = np.float64(1) / 3 + 15
    assert hf.improve(cavity, min_dihedral=third).stuck_below == third
    as_list = hf.improve(cavity, ops=["edge", "face"], iterations=np.int64(1), bulk_nodes=np.bool_(False))
    assert as_list.mesh.hash == hf.improve(cavity, ops="edge,face", iterations=1).mesh.hash
    assert as_list.mesh.hash != hf.improve(cavity, iterations=1).mesh.hash
    assert hf.improve(cavity, min_dihedral="max", time_limit=5).after.min_dihedral > 15
    pinned = hf.improve(cavity, surface="flat", fix=["vertex:0", "edge:0-1"], iterations=1)
    assert (pinned.points[pinned.maps.vertices[0]] == cavity.points[0]).all()


def test_a_mesh_brings_its_own_arrays(cavity):
    with pytest.raises(TypeError, match="a Mesh has its own cells"):
        hf.improve(cavity, cavity.cells)
    with pytest.raises(TypeError, match="a Mesh has its own regions"):
        hf.improve(cavity, regions=[1])
    with pytest.raises(TypeError, match="points and cells are wanted"):
        hf.improve(cavity.points)


def test_plan_says_what_a_run_would_do(cavity, bytes_of):
    before = bytes_of(cavity)
    text = hf.plan(cavity, min_dihedral=20)
    assert len(text.splitlines()) > 10 and text != hf.plan(cavity)
    assert bytes_of(cavity) == before


def test_a_time_limit_ends_a_run_with_a_mesh_no_worse():
    mesh = hf.generate.cavity((20, 20, 20))
    r = hf.improve(mesh, time_limit=1e-3)
    assert r.stop == "time limit"
    assert r.after.inverted <= r.before.inverted and r.after.min_dihedral >= r.before.min_dihedral


def test_a_missing_device_is_an_error_of_its_own(cavity):
    assert issubclass(hf.DeviceError, RuntimeError)
    with pytest.raises(hf.DeviceError, match="opencl:77.0|loader|OpenCL"):
        hf.improve(cavity, device="opencl:77.0")
