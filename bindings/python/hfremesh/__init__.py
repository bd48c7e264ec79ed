# SPDX-License-Identifier: BSD-3-Clause
"""Repairs and improves tetrahedral meshes in place, in parallel.

    import hfremesh as hf
    r = hf.improve(points, cells, min_dihedral=20)   # NumPy in
    r.points, r.cells, r.after.min_dihedral          # NumPy out

Every function that takes points and cells takes a Mesh in place of both. Points: (n, 3) numbers; cells: (m, 4)
integers below n; of any type, strides and byte order. What does not fit raises ValueError that names the first index
at fault, and nothing that was passed in is ever changed.
"""

from ._load import core as _core
from ._api import Check, Result, check, histogram, improve, min_dihedral, plan, quality, stats
from ._core import (
    METRICS,
    DeviceError,
    Distribution,
    Edits,
    FieldReport,
    Maps,
    Mesh,
    Move,
    PatchStatistics,
    Progress,
    RegionStatistics,
    Repair,
    Statistics,
    Step,
    StuckCell,
    SurfaceReport,
    generate,
)
from ._files import read, write
from ._convert import from_meshio, from_pyvista, to_meshio, to_pyvista
from ._remesher import Remesher

__version__: str = _core.__version__

__all__ = [
    "METRICS",
    "Check",
    "DeviceError",
    "Distribution",
    "Edits",
    "FieldReport",
    "Maps",
    "Mesh",
    "Move",
    "PatchStatistics",
    "Progress",
    "RegionStatistics",
    "Remesher",
    "Repair",
    "Result",
    "Statistics",
    "Step",
    "StuckCell",
    "SurfaceReport",
    "check",
    "from_meshio",
    "from_pyvista",
    "generate",
    "histogram",
    "improve",
    "min_dihedral",
    "plan",
    "quality",
    "read",
    "stats",
    "to_meshio",
    "to_pyvista",
    "write",
]
