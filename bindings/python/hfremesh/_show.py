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
    import pyvista
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


def view(before: _core.Mesh, after: _core.Mesh, below: float, axis: int, at: float, options: Any) -> pyvista.Plotter:
    """Both meshes side by side, cut by a plane across an axis, with their poor cells."""
    import pyvista

    plotter = pyvista.Plotter(shape=(1, 2), **options)
    for column, (name, mesh) in enumerate((("before", before), ("after", after))):
        plotter.subplot(0, column)
        points, cells = np.array(mesh.points), np.array(mesh.cells, dtype=np.int64)
        grid = pyvista.UnstructuredGrid({10: cells}, points)  # 10: VTK's tetrahedron
        degrees = np.asarray(_api.min_dihedral(mesh))
        grid.cell_data["smallest angle"] = degrees
        low, high = points[:, axis].min(), points[:, axis].max()
        behind = points[cells, axis].mean(axis=1) <= low + at * (high - low)
        poor, invalid = (degrees > 0) & (degrees < below), degrees <= 0
        faces = np.asarray(mesh.boundary_faces, dtype=np.int64)
        surface = pyvista.PolyData(points, np.column_stack([np.full(len(faces), 3), faces]).ravel())
        plotter.add_mesh(surface, color="grey", opacity=0.08, name=f"surface {name}")
        for what, chosen, style in (
            ("cut", behind & ~poor & ~invalid, {"color": "white", "show_edges": True}),
            ("poor", poor, {"scalars": "smallest angle", "clim": (0.0, below), "cmap": "plasma", "show_edges": True,
                            "scalar_bar_args": {"title": f"smallest angle, {name}"}}),
            ("invalid", invalid, {"color": "red", "show_edges": True}),
        ):
            if chosen.any():
                plotter.add_mesh(grid.extract_cells(np.flatnonzero(chosen)), name=f"{what} {name}", **style)
        plotter.add_text(f"{name}: {len(cells)} cells, {poor.sum()} below {below:g} degrees, "
                         f"{invalid.sum()} inverted or flat", font_size=8)
    plotter.link_views()
    plotter.reset_camera()
    return plotter
