# SPDX-License-Identifier: BSD-3-Clause
"""A mesh inside of a simulation."""

from __future__ import annotations

from typing import Any, Callable, Mapping, Optional, Tuple, Union

from . import _core
from ._api import _option_texts, _transfer_texts


class Remesher(_core.Remesher):
    """A mesh inside of a simulation: its vertices move step by step, and what has become bad is repaired.

        rm = hf.Remesher(mesh, goal=15, trigger=10, transfer={"T": "linear", "p": "conserve"})
        for ...:
            step = rm.step(displacement)          # (n, 3), one row a vertex
            if step.changed:
                points, cells, T = rm.points, rm.cells, rm.field("T")

    Works on a copy of `mesh`; what is read of it is a copy of what it is then.

    goal: degrees that a repair aims at, 'max', or None for a run over everything. trigger: degrees below which a cell
    calls for a repair; 0: not looked at. inverted: whether inverted and flat cells call for one. metrics: {metric:
    value}: a cell that is worse calls for one. jacobian: the same for a cell with less than this share of its first
    volume. distance: the same when a vertex has come so many mean edges since the last repair. every: a repair after so
    many steps. indicator: the name of a field of cells: a cell with a vertex that moves calls for one where the field is
    not 0; write it with set_field() before a step.

    on_inversion, what a move does that would invert cells: 'repair' takes it, 'substeps' takes as much of it as inverts
    nothing, repairs and goes on, at most max_substeps times, 'refuse' takes nothing and names the cells.

    motion: 'given' (a displacement for every vertex), or 'laplace' and 'elastic': of the boundary and of fixed vertices
    alone, which others follow.

    transfer: {name: how} for fields of the mesh: 'linear' or 'quadratic' (of vertices), 'inherit' or 'conserve' (of
    cells), or ('conserve', density), or a function f(old, new, edits) of two Meshes and what the repair did, which returns the new
    values, one row a vertex or cell of `new`; there the field has what operators made of it. Others are attached to
    their vertices and cells.

    parents: the edits of a repair find the parents of created cells when they are first asked for, and keep the mesh as
    it was until then; False leaves them out where no field is inherited. ids: keep numbers of vertices and cells that never change. progress, cancel and further
    options: as improve(), for each repair.

    Raises ValueError for options and arrays that do not fit, with the first index at fault. One step at a time: while
    one is in progress, whatever else is asked of it raises RuntimeError.
    """

    def __init__(
        self,
        mesh: _core.Mesh,
        goal: Union[float, str, None] = 15,
        trigger: float = 10,
        *,
        inverted: Optional[bool] = None,
        metrics: Optional[Mapping[str, float]] = None,
        jacobian: Optional[float] = None,
        distance: Optional[float] = None,
        every: Optional[int] = None,
        indicator: Optional[str] = None,
        on_inversion: Optional[str] = None,
        max_substeps: Optional[int] = None,
        motion: Optional[str] = None,
        transfer: Optional[Mapping[str, Union[str, Tuple[str, str], Callable[..., Any]]]] = None,
        parents: Optional[bool] = None,
        ids: Optional[bool] = None,
        progress: Optional[Callable[[_core.Progress], Any]] = None,
        cancel: Optional[Callable[[], bool]] = None,
        **options: Any,
    ) -> None:
        known = [name for name, _, _, _ in _core.options() if name != "min_dihedral"]
        for name in options:
            if name not in known:
                raise TypeError(f"no option is called {name!r}; there are {', '.join(known)}")
        if not isinstance(mesh, _core.Mesh):
            raise TypeError("a Mesh is wanted")
        functions = {name: how for name, how in (transfer or {}).items() if callable(how)}
        ways = {name: how for name, how in (transfer or {}).items() if not callable(how)}
        texts = _option_texts({**options, "min_dihedral": "none" if goal is None else goal})
        texts += _option_texts(
            {"trigger": trigger, "trigger_inverted": inverted,
             "trigger_metric": [f"{name}:{float(value)!r}" for name, value in (metrics or {}).items()],
             "trigger_jacobian": jacobian, "trigger_motion": distance, "trigger_every": every,
             "trigger_field": indicator,
             "on_inversion": on_inversion, "max_substeps": max_substeps, "motion": motion,
             "transfer": _transfer_texts(ways), "parents": parents, "ids": ids},
            of_remesher=True)
        super().__init__(mesh, texts, progress, cancel, functions)

    def __repr__(self) -> str:
        return (f"<hfremesh.Remesher: {self.n_vertices} vertices, {self.n_cells} cells, smallest dihedral "
                f"{self.min_dihedral:.6g}>")
