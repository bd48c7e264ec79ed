# SPDX-License-Identifier: BSD-3-Clause
import pathlib

import numpy as np
import pytest

import hfremesh as hf


@pytest.mark.parametrize("name", ["a.mesh", "a.meshb", "a.msh", "a.vtk", "a.vtu", "a.ovm", "a.node"])
def test_what_is_written_can_be_read(tmp_path, cavity, name):
    notes = hf.write(tmp_path / name, cavity)
    assert isinstance(notes, list)
    assert hf.read(str(tmp_path / name)).hash == cavity.hash


def test_fields_and_names_go_through_files(tmp_path, tet):
    points, cells = tet
    mesh = hf.Mesh(points, cells, regions=[7], triangles=[[0, 2, 1]], triangle_labels=[3], names={(3, 7): "steel"},
                   fields={"T": [1.0, 2, 3, 4]})
    hf.write(tmp_path / "a.msh", mesh, variant="4.1", binary=True)
    back = hf.read(tmp_path / "a.msh")
    assert back.hash == mesh.hash and back.attachments["names"] == {(3, 7): "steel"}
    np.testing.assert_array_equal(back.attachments["point_fields"]["T"], [1, 2, 3, 4])


def test_what_a_format_cannot_hold_is_said(tmp_path, tet):
    mesh = hf.Mesh(*tet, fields={"T": [1.0, 2, 3, 4]}, names={(3, 1): "steel"}, regions=[1])
    notes = hf.write(tmp_path / "a.node", mesh)
    assert any("names" in note or "steel" in note for note in notes)


def test_results_can_be_written(tmp_path, cavity):
    r = hf.improve(cavity, iterations=1)
    hf.write(tmp_path / "r.mesh", r)
    assert hf.read(tmp_path / "r.mesh").hash == r.mesh.hash


def test_errors_say_where(tmp_path, cavity):
    with pytest.raises(OSError, match="missing.mesh: cannot be opened"):
        hf.read(tmp_path / "missing.mesh")
    with pytest.raises(ValueError, match="unknown file type '.xyz'"):
        hf.write(tmp_path / "a.xyz", cavity)
    with pytest.raises(OSError, match="nowhere"):
        hf.write(tmp_path / "nowhere" / "a.mesh", cavity)
    bad = tmp_path / "bad.mesh"
    bad.write_text("MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 zero 0\n")
    with pytest.raises(ValueError, match=r"bad.mesh:4"):
        hf.read(bad)
    triangles = tmp_path / "t.off"
    triangles.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    with pytest.raises(ValueError, match="no tetrahedra"):
        hf.read(triangles)
    assert sorted(p.name for p in pathlib.Path(tmp_path).iterdir()) == ["bad.mesh", "t.off"]
