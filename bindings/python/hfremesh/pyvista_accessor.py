# SPDX-License-Identifier: BSD-3-Clause
"""grid.hfremesh.improve(...) on PyVista's unstructured grids, from PyVista 0.48 on, which finds this module by its
entry point 'pyvista.accessors'."""

from __future__ import annotations

from typing import Any

import pyvista

from . import _api, _convert, _core


@pyvista.register_dataset_accessor("hfremesh", pyvista.UnstructuredGrid)
class Accessor:
    """The library's functions for one grid, which stays as it is."""

    def __init__(self, grid: pyvista.UnstructuredGrid) -> None:
        self._grid = grid

    def mesh(self) -> _core.Mesh:
        """The grid as a Mesh."""
        return _convert.from_pyvista(self._grid)

    def improve(self, **options: Any) -> pyvista.UnstructuredGrid:
        """A better grid; options as improve(). The run's Result is at .hfremesh.result of the grid that is returned."""
        result = _api.improve(self.mesh(), **options)
        grid = _convert.to_pyvista(result.mesh)
        grid.hfremesh.result = result
        return grid

    def stats(self) -> _core.Statistics:
        """Figures of the grid."""
        return _api.stats(self.mesh())

    def check(self) -> _api.Check:
        """Can a solver take it?"""
        return _api.check(self.mesh())

    def quality(self, metric: str = "volume-length") -> Any:
        """(m,) float64: a metric's value for each tetrahedron."""
        return _api.quality(self.mesh(), metric=metric)
