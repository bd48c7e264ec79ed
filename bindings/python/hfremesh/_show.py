# SPDX-License-Identifier: BSD-3-Clause
"""Pages, pictures and plots of a mesh before and after."""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, List, Optional, Union

import numpy as np

from . import _api, _core, _files

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    Path_ = Union[str, os.PathLike[str]]


def report(before: _core.Mesh, after: _core.Mesh, page: Optional[Path_], picture: Optional[Path_]) -> None:
    """What 'hfremesh report' makes of two meshes: by the tool that the package carries."""
    tool = Path(__file__).parent / "bin" / "hfremesh"
    wanted: List[str] = []
    for option, path in (("-o", page), ("--png", picture)):
        if path is not None:
            wanted += [option, os.path.abspath(os.fspath(path))]
    with tempfile.TemporaryDirectory() as folder:
        files = [os.path.join(folder, name) for name in ("before.meshb", "after.meshb")]
        for file, mesh in zip(files, (before, after)):
            _files.write(file, mesh)
        done = subprocess.run([str(tool), "report", *files, *wanted, "-q"], capture_output=True, text=True)
    if done.returncode != 0:
        raise OSError(done.stderr.strip().removeprefix("hfremesh: "))


def plot(before: _core.Mesh, after: _core.Mesh, figures: List[_core.Statistics]) -> Figure:
    """Histograms of all dihedral angles and of each cell's smallest, before and after."""
    import matplotlib.pyplot as plt

    figure, (all_angles, smallest) = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
    styles: Any = ({"color": "tab:orange", "fill": False, "linewidth": 1.6}, {"color": "tab:blue", "fill": True, "alpha": 0.6})
    for name, mesh, s, style in zip(("before", "after"), (before, after), figures, styles):
        counts = np.asarray(s.dihedral_histogram, float)
        all_angles.stairs(100 * counts / max(1.0, counts.sum()), np.arange(0, 181, 5),
                          label=f"{name}: {s.min_dihedral:.2f}° to {s.max_dihedral:.2f}°", **style)
        degrees = _api.min_dihedral(mesh)
        counts, edges = np.histogram(degrees, bins=72, range=(0, 72))
        invalid = int((degrees <= 0).sum())
        label = f"{name}: {invalid} inverted or flat" if invalid else name
        smallest.stairs(100 * counts / max(1, len(degrees)), edges, label=label, **style)
    for axes, title in ((all_angles, "all dihedral angles"), (smallest, "smallest dihedral angle of each cell")):
        axes.set_title(title)
        axes.set_xlabel("degrees")
        axes.set_ylabel("%")
        axes.legend()
    return figure
