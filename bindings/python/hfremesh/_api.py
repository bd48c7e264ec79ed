# SPDX-License-Identifier: BSD-3-Clause
"""What users call, over the extension module."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core

if TYPE_CHECKING:
    import pyvista
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    MeshLike = Union[_core.Mesh, ArrayLike]

#: Below: rounding. The sums of absolute volumes and of the enclosed volume differ by it in a mesh without overlap.
_OVERLAP_TOLERANCE = 1e-9


def _mesh(points: MeshLike, cells: Optional[ArrayLike], **attached: Any) -> _core.Mesh:
    if not isinstance(points, _core.Mesh):
        if cells is None:
            raise TypeError("points and cells are wanted, or a Mesh")
        return _core.Mesh(points, cells, **attached)
    given = [name for name, value in attached.items() if value is not None and name != "threads"]
    if cells is not None or given:
        raise TypeError(f"a Mesh has its own {'cells' if cells is not None else given[0]}; give points and cells instead")
    return points


def _text(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)


def _option_texts(given: Mapping[str, Any], of_remesher: bool = False) -> List[Tuple[str, str]]:
    """Names and texts in the order of the library's table; None is left out."""
    texts = []
    for name, _, _, repeats in _core.options(of_remesher):
        value = given.get(name)
        if value is None:
            continue
        if isinstance(value, (list, tuple)) and repeats:
            texts += [(name, _text(item)) for item in value]
        elif isinstance(value, (list, tuple)):
            texts.append((name, ",".join(_text(item) for item in value)))
        else:
            texts.append((name, _text(value)))
    return texts


def _transfer_texts(transfer: Optional[Mapping[str, Union[str, Tuple[str, str]]]]) -> List[str]:
    """{"T": "linear", "u": ("conserve", "rho")} as the library's table has it."""
    return [f"{name}:{how if isinstance(how, str) else ':'.join(how)}" for name, how in (transfer or {}).items()]


class Result:
    """What a run did, and the mesh that it made.

    points, cells: the new mesh's arrays; mesh: the mesh itself. before, after: Statistics. maps: what became of
    vertices and cells. stuck: the cells below stuck_below degrees and what keeps each.
    """

    def __init__(self, run: _core.Result, before: _core.Mesh, point_fields: Dict[str, np.dtype], cell_fields: Dict[str, np.dtype]) -> None:
        self._run = run
        self._before = before
        self._edits: Optional[_core.Edits] = None
        self._types = {"point_fields": point_fields, "cell_fields": cell_fields}
        self._attached: Optional[Dict[str, Any]] = None

    def _fields(self, kind: str) -> Dict[str, NDArray[Any]]:
        if self._attached is None:
            self._attached = self._run.mesh.attachments
        types = self._types[kind]
        return {name: values.astype(types.get(name, values.dtype), copy=False)
                for name, values in self._attached[kind].items()}

    @property
    def mesh(self) -> _core.Mesh:
        """The mesh after the run."""
        return self._run.mesh

    @property
    def points(self) -> NDArray[np.float64]:
        """(n, 3) float64: coordinates after the run; a view of the mesh."""
        return self._run.mesh.points

    @property
    def cells(self) -> NDArray[np.int32]:
        """(m, 4) int32: cells after the run; a read-only view of the mesh."""
        return self._run.mesh.cells

    @property
    def regions(self) -> NDArray[np.int32]:
        """(m,) int32: the region of each cell; 0 where none was given."""
        return self._run.mesh.regions

    @property
    def point_fields(self) -> Dict[str, NDArray[Any]]:
        """Fields of vertices. Those that `transfer` names are carried over; the values of others are attached: a vertex
        that moved keeps its value, a new one has that of the vertex in maps.sources."""
        return self._fields("point_fields")

    @property
    def cell_fields(self) -> Dict[str, NDArray[Any]]:
        """Fields of cells. Those that `transfer` names are carried over; of others a new cell has the values of the cell
        in whose place it came."""
        return self._fields("cell_fields")

    @property
    def fields(self) -> Dict[str, NDArray[Any]]:
        """point_fields and cell_fields in one; of two of one name, that of the vertices."""
        return {**self.cell_fields, **self.point_fields}

    @property
    def changed(self) -> bool:
        """Whether anything is another than before."""
        return self._run.changed

    @property
    def goal_reached(self) -> bool:
        """Nothing inverted or flat, and min_dihedral met where given."""
        return self._run.goal_reached

    @property
    def stop(self) -> str:
        """'goal', 'no progress', 'iterations', 'time limit', 'cancelled' or 'device lost'."""
        return self._run.stop

    @property
    def cancelled(self) -> bool:
        """Whether KeyboardInterrupt or cancel() ended the run; the mesh is the best so far."""
        return self._run.stop == "cancelled"

    @property
    def before(self) -> _core.Statistics:
        """Figures of the mesh before; all 0 with statistics=False."""
        return self._run.before

    @property
    def after(self) -> _core.Statistics:
        """Figures of the mesh after; all 0 with statistics=False."""
        return self._run.after

    @property
    def maps(self) -> _core.Maps:
        """What became of vertices and cells; empty with maps=False."""
        return self._run.maps

    @property
    def edits(self) -> _core.Edits:
        """What the run did, element by element; found when first asked for, from the mesh as it was, whose points must
        not have been moved meanwhile."""
        if self._edits is None:
            if len(self.maps.old_cells) == 0 < self.mesh.n_cells:
                raise ValueError("edits need maps=True")
            self._edits = _core.edits(self._before, self._run)
        return self._edits

    @property
    def transferred(self) -> List[_core.FieldReport]:
        """What became of the fields that `transfer` names."""
        return self._run.transferred

    @property
    def surface(self) -> _core.SurfaceReport:
        """What became of the surface; all 0 while it is frozen."""
        return self._run.surface

    @property
    def stuck(self) -> List[_core.StuckCell]:
        """The cells below stuck_below degrees, with what keeps each."""
        return self._run.stuck

    @property
    def stuck_below(self) -> float:
        """Degrees: the goal or, without one, the first angle that was tried for and missed."""
        return self._run.stuck_below

    @property
    def invalid_cells(self) -> NDArray[np.int64]:
        """(k,) int64: inverted or flat cells that remain."""
        return self._run.invalid_cells

    @property
    def seconds(self) -> float:
        """Of the work itself, statistics apart."""
        return self._run.seconds

    @property
    def device(self) -> str:
        """Name of the device that was used; empty: none."""
        return self._run.device

    @property
    def device_note(self) -> str:
        """Why a device that was wanted was not used, or not to the end."""
        return self._run.device_note

    def report(self, path: Union[str, os.PathLike[str], None], *, png: Union[str, os.PathLike[str], None] = None) -> None:
        """Writes a page about the mesh before and after, one HTML file with histograms and views of both, and with png a
        picture (docs/reports.md); path may be None then. The points of the mesh before must not have been moved
        meanwhile. OSError when a file cannot be written."""
        from . import _show
        if path is None and png is None:
            raise ValueError("a path for the page is wanted, or one for the picture")
        _show.report(self._before, self.mesh, path, png)

    def plot(self) -> Figure:
        """Histograms of all dihedral angles and of each cell's smallest, before and after, as a figure of matplotlib,
        which has to be there. Needs statistics=True."""
        from . import _show
        if self.after.cells == 0 < self.mesh.n_cells:
            raise ValueError("plot() needs statistics=True")
        return _show.plot(self._before, self.mesh, [self.before, self.after])

    def view(self, *, below: float = 15.0, axis: str = "x", at: float = 0.5, **options: Any) -> pyvista.Plotter:
        """The meshes before and after side by side, cameras linked, as a plotter of PyVista, which has to be there: the
        surface, the cells whose centre lies before a plane across the axis 'x', 'y' or 'z' at a share of the extent
        (0 to 1), and, wherever they are, the cells with an angle below so many degrees, coloured by it, and the inverted
        and flat ones in red. `options` go to pyvista.Plotter, such as off_screen=True; .show() opens the window,
        .screenshot(path) writes a picture. ValueError for another axis or a share out of range."""
        from . import _show
        if axis not in ("x", "y", "z") or not 0 <= at <= 1:
            raise ValueError(f"axis is x, y or z and at 0 to 1, not {axis!r} and {at}")
        return _show.view(self._before, self.mesh, below, "xyz".index(axis), at, options)

    def __repr__(self) -> str:
        return (f"<hfremesh.Result: {self.mesh.n_cells} cells, {len(self.invalid_cells)} invalid, "
                f"{'changed' if self.changed else 'unchanged'}, stop: {self.stop}>")


def _types_of(fields: Optional[Mapping[str, ArrayLike]]) -> Dict[str, np.dtype]:
    """Types to give results back in: those that were given, where they hold every value."""
    return {name: np.asarray(values).dtype.newbyteorder("=") for name, values in (fields or {}).items()}


def improve(
    points: MeshLike,
    cells: Optional[ArrayLike] = None,
    *,
    min_dihedral: Union[float, str, None] = None,
    iterations: Optional[int] = None,
    time_limit: Optional[float] = None,
    surface: Optional[str] = None,
    hausdorff: Optional[float] = None,
    feature_angle: Optional[float] = None,
    fix: Union[str, Sequence[str], None] = None,
    periodic: Union[str, Sequence[str], None] = None,
    min_cells: Optional[int] = None,
    max_cells: Optional[int] = None,
    coarsen: Optional[bool] = None,
    metric: Optional[str] = None,
    ops: Union[str, Sequence[str], None] = None,
    no_insert: Optional[bool] = None,
    bulk_nodes: Optional[bool] = None,
    polish_only: Optional[bool] = None,
    passes_only: Optional[bool] = None,
    rounds: Optional[str] = None,
    smoother: Optional[str] = None,
    compat: Optional[str] = None,
    seed: Optional[int] = None,
    threads: Optional[int] = None,
    device: Optional[str] = None,
    hybrid: Optional[bool] = None,
    work_group: Optional[int] = None,
    regions: Optional[ArrayLike] = None,
    fields: Optional[Mapping[str, ArrayLike]] = None,
    point_fields: Optional[Mapping[str, ArrayLike]] = None,
    cell_fields: Optional[Mapping[str, ArrayLike]] = None,
    triangles: Optional[ArrayLike] = None,
    triangle_labels: Optional[ArrayLike] = None,
    fixed_vertices: Optional[ArrayLike] = None,
    progress: Optional[Callable[[_core.Progress], Any]] = None,
    cancel: Optional[Callable[[], bool]] = None,
    transfer: Optional[Mapping[str, Union[str, Tuple[str, str]]]] = None,
    statistics: bool = True,
    maps: bool = True,
) -> Result:
    """Repairs and improves a mesh; the one that is given stays as it is.

    points: (n, 3) numbers, cells: (m, 4) integers below n; or a Mesh in place of both. Options have the names and the
    meaning of the tool's (docs/tool.md):

    min_dihedral: degrees below 70.5 or 'max'. With a goal only cells that miss it are worked on; without one the whole
    mesh is improved. time_limit: seconds. surface: 'frozen' (the boundary keeps every bit; the default), 'flat' or
    'free', with hausdorff (a length) and feature_angle (degrees). fix: 'patch:N', 'vertex:N', 'edge:N-N' or
    'face:N-N-N', one or a list. ops: a list of operators. threads: 0 or None is every core; the result is the same.

    regions: (m,) integers. fields: {name: array of n or m rows}; point_fields and cell_fields say which. triangles:
    (k, 3) faces that stay as they are. fixed_vertices: (k,).

    transfer: {name: how}, how being 'linear' or 'quadratic' (fields of vertices), 'inherit' or 'conserve' (fields of
    cells), or ('conserve', density), a field that values are weighted by. Other fields are attached to their vertices and cells.

    progress: called between passes with a Progress. cancel: asked between passes; True ends the run. KeyboardInterrupt
    does, too. Either way the result has the best mesh so far, and stop is 'cancelled'. What a callback raises is
    raised here. The GIL is released while the run works.

    Raises ValueError for arrays and options that do not fit, with the first index at fault; DeviceError for a device
    that is missing.
    """
    texts = _option_texts({
        "min_dihedral": min_dihedral, "iterations": iterations, "time_limit": time_limit, "surface": surface,
        "hausdorff": hausdorff, "feature_angle": feature_angle, "fix": fix, "periodic": periodic,
        "min_cells": min_cells, "max_cells": max_cells, "coarsen": coarsen, "metric": metric, "ops": ops,
        "no_insert": no_insert, "bulk_nodes": bulk_nodes, "polish_only": polish_only,
        "passes_only": passes_only, "rounds": rounds, "smoother": smoother, "compat": compat,
        "seed": seed, "threads": threads, "device": device, "hybrid": hybrid, "work_group": work_group,
    })
    mesh = _mesh(points, cells, regions=regions, fields=fields, point_fields=point_fields, cell_fields=cell_fields,
                 triangles=triangles, triangle_labels=triangle_labels, fixed_vertices=fixed_vertices,
                 threads=threads or 0)
    run = _core.improve(mesh, texts, progress, cancel, statistics, maps, _transfer_texts(transfer))
    return Result(run, mesh, _types_of({**(fields or {}), **(point_fields or {})}),
                  _types_of({**(fields or {}), **(cell_fields or {})}))


def plan(points: MeshLike, cells: Optional[ArrayLike] = None, **options: Any) -> str:
    """What improve() would do with these options: its stages and the numbers that each works by. Nothing is done."""
    known = [name for name, _, _, _ in _core.options()]
    for name in options:
        if name not in known:
            raise TypeError(f"no option is called {name!r}; there are {', '.join(known)}")
    return _core.plan(_mesh(points, cells, threads=options.get("threads") or 0), _option_texts(options))


def stats(points: MeshLike, cells: Optional[ArrayLike] = None, *, regions: Optional[ArrayLike] = None,
          threads: int = 0) -> _core.Statistics:
    """Figures of a mesh: counts, angles in degrees, histograms, volumes, regions. ValueError for arrays that do not
    fit."""
    return _core.statistics(_mesh(points, cells, regions=regions, threads=threads), threads)


def quality(points: MeshLike, cells: Optional[ArrayLike] = None, metric: str = "volume-length", *,
            threads: int = 0) -> NDArray[np.float64]:
    """(m,) float64: a metric's value for each cell, as the literature prints it; negative for an inverted cell.
    metric: one of METRICS. ValueError for another."""
    return _core.quality(_mesh(points, cells, threads=threads), metric, threads)


def min_dihedral(points: MeshLike, cells: Optional[ArrayLike] = None, *, threads: int = 0) -> NDArray[np.float64]:
    """(m,) float64: each cell's smallest dihedral angle, degrees; negative for an inverted cell."""
    return quality(points, cells, "min-dihedral", threads=threads)


def histogram(points: MeshLike, cells: Optional[ArrayLike] = None, metric: str = "min-dihedral",
              bins: Union[int, Sequence[float]] = 36,
              range: Optional[Tuple[float, float]] = None, *, threads: int = 0) -> Tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Counts and edges of numpy.histogram over quality(points, cells, metric). That of all six dihedrals of all cells
    is stats().dihedral_histogram."""
    return np.histogram(quality(points, cells, metric, threads=threads), bins=bins, range=range)


@dataclass(frozen=True)
class Check:
    """What check() found; true when a solver can take the mesh."""

    valid: bool
    inverted: NDArray[np.int64]  #: (k,) cells of negative volume
    flat: NDArray[np.int64]  #: (k,) cells whose volume hides in rounding
    reoriented: NDArray[np.int64]  #: (k,) cells whose order contradicted their neighbours'
    overlap: float  #: by how much the cells' volumes exceed what the boundary encloses, as a share
    folded: NDArray[np.int64]  #: (k, 3) boundary faces that lie on or go through another; no fault by itself
    rule: str  #: the first broken rule of the structure, "kNone" where there is none
    message: str  #: a line about it
    is_manifold: bool  #: false: parts only touch in an edge or a vertex, which is no fault by itself

    def __bool__(self) -> bool:
        return self.valid


def check(points: MeshLike, cells: Optional[ArrayLike] = None, *, regions: Optional[ArrayLike] = None,
          threads: int = 0) -> Check:
    """Is this a mesh that a solver can take? The answer is that of 'hfremesh check': no cell inverted, flat or ordered
    against its neighbours, no overlap, and a sound structure. ValueError where no mesh can be made of the arrays."""
    mesh = _mesh(points, cells, regions=regions, threads=threads)
    figures = _core.statistics(mesh, threads)
    rule, message, _, _ = _core.structure(mesh, threads)
    touches = rule in ("kNonManifoldEdge", "kNonManifoldVertex")
    sound = rule in ("kNone", "kLabel") or touches
    bad = figures.inverted + figures.flat + len(mesh.reoriented)
    return Check(
        valid=bool(sound and bad == 0 and figures.overlap <= _OVERLAP_TOLERANCE),
        inverted=figures.inverted_cells, flat=figures.flat_cells, reoriented=mesh.reoriented,
        overlap=figures.overlap, folded=_core.folded_faces(mesh, threads), rule=rule, message=message,
        is_manifold=not touches)
