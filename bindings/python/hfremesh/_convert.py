# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of meshio and PyVista. Both are optional and imported where they are called."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Optional, Tuple

import numpy as np

from . import _core

if TYPE_CHECKING:
    import meshio
    import pyvista

#: Cell arrays that say what belongs together, case apart: those of the VTK reader (docs/file-formats.md).
_LABELS = ("region", "regions", "material", "materials", "materialids", "material_id", "medit:ref", "gmsh:physical",
           "label", "labels", "regionid", "region_id", "cellentityids", "cell_tags", "subdomain", "attribute")

_VTK_TETRA, _VTK_TRIANGLE, _VTK_LINE = 10, 5, 3


def _is_label(values: Any) -> bool:
    values = np.asarray(values)  # of None, an array of objects without dimensions
    return values.ndim == 1 and values.dtype.kind in "iuf" and bool(np.all(values == np.rint(values)))


def _label_name(names: Any, values_of: Any) -> Optional[str]:
    lower = {name.lower(): name for name in reversed(list(names))}
    for known in _LABELS:
        if known in lower and _is_label(values_of(lower[known])):
            return lower[known]
    return None


def _scalars(blocks: Any) -> Any:
    """Values of all blocks of cells one after the other; None where they are vectors."""
    arrays = [np.asarray(values) for values in blocks]
    return np.concatenate(arrays) if all(values.ndim == 1 for values in arrays) else None


def _numbers(fields: Dict[str, Any]) -> Dict[str, Any]:
    """Those that the library can carry, tensors as rows."""
    kept = {}
    for name, values in fields.items():
        values = np.asarray(values)
        if values.dtype.kind in "iuf" and values.ndim >= 1:
            kept[name] = values if values.ndim == 1 else values.reshape(len(values), -1)
    return kept


def from_meshio(mesh: meshio.Mesh) -> _core.Mesh:
    """The tetrahedra of a meshio mesh, its triangles and lines as labelled faces and edges, and its data as fields.
    Regions and labels are the first of 'region', 'medit:ref', 'gmsh:physical', … that is there. ValueError where it has
    no 'tetra' cells."""
    of_kind: Dict[str, Tuple[list, list]] = {}
    for i, block in enumerate(mesh.cells):
        blocks, numbers = of_kind.setdefault(block.type, ([], []))
        blocks.append(block.data)
        numbers.append(i)
    if "tetra" not in of_kind:
        raise ValueError(f"there are no cells of type 'tetra' but {', '.join(of_kind) or 'none'}")

    def gathered(name: str, kind: str) -> Any:
        return np.concatenate([mesh.cell_data[name][i] for i in of_kind[kind][1]])

    label = _label_name(mesh.cell_data, lambda name: _scalars(mesh.cell_data[name]))
    parts: Dict[str, Any] = {}
    for kind, items, labels in (("triangle", "triangles", "triangle_labels"), ("line", "edges", "edge_labels")):
        if kind in of_kind:
            parts[items] = np.concatenate(of_kind[kind][0])
            if label:
                parts[labels] = gathered(label, kind).astype(np.int64)
    return _core.Mesh(
        _three_columns(mesh.points), np.concatenate(of_kind["tetra"][0]),
        regions=gathered(label, "tetra").astype(np.int64) if label else None,
        point_fields=_numbers(mesh.point_data),
        cell_fields=_numbers({name: gathered(name, "tetra") for name in mesh.cell_data if name != label}), **parts)


def _three_columns(points: Any) -> Any:
    points = np.asarray(points)
    if points.ndim == 2 and points.shape[1] == 2:
        raise ValueError("points: an array of shape (n, 3) is wanted; this mesh is two-dimensional")
    return points


def _require_no_field_of_regions(fields: Any) -> None:
    if "region" in fields:
        raise ValueError("a field of cells is called 'region', as regions and labels are to be: give it another name")


def to_meshio(mesh: _core.Mesh) -> meshio.Mesh:
    """A meshio mesh: tetrahedra, and labelled triangles and lines where there are any; regions and labels as 'region',
    fields of cells as they are (NaN on triangles and lines). ValueError where a field of cells is called 'region', too."""
    import meshio

    mesh = getattr(mesh, "mesh", mesh)
    more = mesh.attachments
    blocks = [("tetra", np.array(mesh.cells, dtype=np.int64), mesh.regions)]
    for kind, items, labels in (("triangle", "triangles", "triangle_labels"), ("line", "edges", "edge_labels")):
        if len(more[items]):
            blocks.append((kind, more[items], more[labels]))
    cell_data: Dict[str, list] = {}
    if any(labels.any() for _, _, labels in blocks):
        _require_no_field_of_regions(more["cell_fields"])
        cell_data["region"] = [labels for _, _, labels in blocks]
    for name, values in more["cell_fields"].items():
        fill = [np.full((len(items), *values.shape[1:]), np.nan) for _, items, _ in blocks[1:]]
        cell_data[name] = [values, *fill]
    return meshio.Mesh(np.array(mesh.points), [(kind, items) for kind, items, _ in blocks],
                       point_data=more["point_fields"], cell_data=cell_data)


def from_pyvista(grid: pyvista.UnstructuredGrid) -> _core.Mesh:
    """The tetrahedra of an unstructured grid, its triangles and lines as labelled faces and edges, and its arrays as
    fields. Regions and labels are the first cell array of 'region', 'material', … that is there. ValueError where it
    has cells of another kind."""
    types = np.asarray(grid.celltypes)
    others = sorted(set(types.tolist()) - {_VTK_TETRA, _VTK_TRIANGLE, _VTK_LINE})
    if others:
        first = int(np.flatnonzero(types == others[0])[0])
        raise ValueError(f"cell {first} has VTK type {others[0]}; tetrahedra, triangles and lines are taken")
    by_type = grid.cells_dict
    if _VTK_TETRA not in by_type:
        raise ValueError("there are no tetrahedra in the grid")
    label = _label_name(grid.cell_data.keys(), lambda name: grid.cell_data[name])
    parts: Dict[str, Any] = {}
    for number, items, labels in ((_VTK_TRIANGLE, "triangles", "triangle_labels"), (_VTK_LINE, "edges", "edge_labels")):
        if number in by_type:
            parts[items] = by_type[number]
            if label:
                parts[labels] = np.asarray(grid.cell_data[label])[types == number].astype(np.int64)
    tets = types == _VTK_TETRA
    return _core.Mesh(
        np.asarray(grid.points), by_type[_VTK_TETRA],
        regions=np.asarray(grid.cell_data[label])[tets].astype(np.int64) if label else None,
        point_fields=_numbers(dict(grid.point_data.items())),
        cell_fields=_numbers({k: np.asarray(v)[tets] for k, v in grid.cell_data.items() if k != label}), **parts)


def to_pyvista(mesh: _core.Mesh) -> pyvista.UnstructuredGrid:
    """An unstructured grid of the tetrahedra with their fields, and their regions as 'region' where there are any.
    ValueError where a field of cells is called so, too."""
    import pyvista

    mesh = getattr(mesh, "mesh", mesh)
    more = mesh.attachments
    grid = pyvista.UnstructuredGrid({_VTK_TETRA: np.array(mesh.cells, dtype=np.int64)}, np.array(mesh.points))
    for name, values in more["point_fields"].items():
        grid.point_data[name] = values
    for name, values in more["cell_fields"].items():
        grid.cell_data[name] = values
    if mesh.regions.any():
        _require_no_field_of_regions(more["cell_fields"])
        grid.cell_data["region"] = mesh.regions
    return grid
