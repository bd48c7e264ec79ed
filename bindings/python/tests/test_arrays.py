# SPDX-License-Identifier: BSD-3-Clause
"""What may come in, and how what may not is refused."""

import numpy as np
import pytest

import hfremesh as hf

INTEGERS = [np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64]


@pytest.mark.parametrize("dtype", [*INTEGERS, ">i4", ">u8"])
def test_cells_of_every_integer_type_give_the_same_mesh(tet, dtype):
    points, cells = tet
    assert hf.Mesh(points, np.array(cells, dtype)).hash == hf.Mesh(points, cells).hash


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, np.longdouble, np.int32, ">f8", ">f4"])
def test_points_of_every_number_type_give_the_same_mesh(tet, dtype):
    points, cells = tet
    assert hf.Mesh(np.array(points, dtype), cells).hash == hf.Mesh(points, cells).hash


def layouts(array):
    padded = np.zeros((2 * len(array), array.shape[1] + 3), array.dtype)
    padded[::2, 1 : 1 + array.shape[1]] = array
    yield "Fortran", np.asfortranarray(array)
    yield "strided", padded[::2, 1 : 1 + array.shape[1]]
    yield "backwards", array[::-1][::-1]
    record = np.zeros(len(array), [("tag", np.int8), ("value", array.dtype, (array.shape[1],))])
    record["value"] = array
    yield "unaligned", record["value"]
    frozen = array.copy()
    frozen.flags.writeable = False
    yield "read-only", frozen


def test_memory_order_makes_no_difference(cavity):
    points, cells = np.array(cavity.points), np.array(cavity.cells)
    seen = 0
    for (name, p), (_, c) in zip(layouts(points), layouts(cells)):
        assert hf.Mesh(p, c).hash == cavity.hash, name
        seen += 1
    assert seen == 5


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda p, c: (p[:, :2], c), r"points: an array of shape \(n, 3\) is wanted, not \(4, 2\)"),
        (lambda p, c: (p[0], c), r"points: .* not \(3,\)"),
        (lambda p, c: (p, c[:, :3]), r"cells: an array of shape \(m, 4\) is wanted, not \(1, 3\)"),
        (lambda p, c: (p, c.astype(float)), "cells: an array of integers is wanted"),
        (lambda p, c: (p.astype(str), c), "points: an array of integers or floats is wanted, not of str"),
        (lambda p, c: (p.astype(complex), c), "points: .* not of complex128"),
        (lambda p, c: (p, c > 0), "cells: .* not of bool"),
        (lambda p, c: (p, c + 1), r"cells\[0, 3\] is 4, out of range: there are 4 points"),
        (lambda p, c: (p, c - 1), r"cells\[0, 0\] is -1, out of range"),
        (lambda p, c: (p, c + 2**32), r"cells\[0, 0\] is 4294967296, out of range"),
        (lambda p, c: (p, np.array([[0, 1, 2, 2**64 - 1]], np.uint64)), r"cells\[0, 3\] is 18446744073709551615"),
        (lambda p, c: (np.where(p == 1, np.nan, p), c), r"points\[1, 0\] is nan; coordinates must be finite"),
        (lambda p, c: (np.where(p == 1, -np.inf, p), c), r"points\[1, 0\] is -inf"),
        (lambda p, c: (p, [[0, 1, 2, 2]]), "cell 0: a vertex appears twice"),
        (lambda p, c: (p, [[0, 1, 2, 3], [0, 1, 2, 3]]), "cell"),
    ],
)
def test_what_does_not_fit_is_named(tet, change, message):
    points, cells = change(np.array(tet[0]), np.array(tet[1]))
    for door in (hf.Mesh, hf.improve, hf.stats, hf.check, hf.quality, hf.min_dihedral, hf.plan, hf.histogram):
        with pytest.raises(ValueError, match=message):
            door(points, cells)


@pytest.mark.parametrize(
    "extra, message",
    [
        ({"regions": [1, 2]}, r"regions: .*\(1,\), one a cell, is wanted, not \(2,\)"),
        ({"regions": [2**31]}, r"regions\[0\] is 2147483648"),
        ({"regions": [1.5]}, "regions: an array of integers"),
        ({"fields": {"T": [1, 2]}}, r"fields\['T'\] has 2 rows, and there are 4 points and 1 cells"),
        ({"point_fields": {"T": [1.0]}}, r"point_fields\['T'\]: .*\(4,\)"),
        ({"cell_fields": {"T": [2**53 + 2]}}, r"cell_fields\['T'\]\[0\] is 9007199254740994"),
        ({"fields": {"T": [1.0]}, "cell_fields": {"T": [1.0]}}, "two fields of cells are called 'T'"),
        ({"triangles": [[0, 1, 9]]}, r"triangles\[0, 2\] is 9"),
        ({"triangle_labels": [1]}, "triangle_labels were given without triangles"),
        ({"triangles": [[0, 1, 2]], "triangle_labels": [1, 2]}, "triangle_labels"),
        ({"fixed_vertices": [0, 4]}, r"fixed_vertices\[1\] is 4"),
        ({"threads": -1}, "threads: a whole number from 0 to 1024"),
    ],
)
def test_what_hangs_on_a_mesh_is_checked_too(tet, extra, message):
    with pytest.raises(ValueError, match=message):
        hf.Mesh(*tet, **extra)


def test_a_field_that_could_be_of_points_or_cells_is_refused():
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
    cells = [[0, 1, 2, 3], [1, 2, 3, 4], [0, 1, 2, 4], [0, 1, 3, 4], [0, 2, 3, 4]]
    with pytest.raises(ValueError, match="use point_fields or cell_fields"):
        hf.Mesh(points, cells, fields={"T": np.zeros(5)})


def test_an_empty_mesh_is_a_mesh():
    mesh = hf.Mesh(np.zeros((0, 3)), np.zeros((0, 4), int))
    assert (mesh.n_vertices, mesh.n_cells) == (0, 0)
    assert mesh.points.shape == (0, 3) and mesh.cells.shape == (0, 4)
    assert hf.stats(mesh).cells == 0


def test_failed_calls_leave_their_arguments_alone(cavity, bytes_of):
    points, cells = np.array(cavity.points), np.array(cavity.cells)
    before = points.tobytes(), cells.tobytes(), bytes_of(cavity)
    with pytest.raises(ValueError):
        hf.improve(points, cells, min_dihedral=-3)
    with pytest.raises(ValueError):
        hf.improve(points, cells, surface="loose")
    with pytest.raises(ValueError, match="vertex:99999: there are 990 vertices"):
        hf.improve(cavity, surface="flat", fix="vertex:99999")
    assert (points.tobytes(), cells.tobytes(), bytes_of(cavity)) == before
