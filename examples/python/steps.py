# SPDX-License-Identifier: BSD-3-Clause
"""A loop of time steps with fields that are carried over whatever repairs the mesh. Runs as it is: python steps.py"""

import numpy as np

import hfremesh as hf


def motion(points, angle):
    """Turns what lies near the axis of the unit cube; its surface stays."""
    p = points - 0.5
    a = angle * np.clip(1 - 2 * abs(p).max(axis=1), 0, None)
    x, y, z = p.T
    return np.stack([np.cos(a) * x - np.sin(a) * y, np.sin(a) * x + np.cos(a) * y, z], axis=1) - p


box = hf.generate.box((7, 7, 7))
mesh = hf.Mesh(box.points, box.cells, point_fields={"T": np.array(box.points)[:, 2]},
               cell_fields={"material": np.array(box.points)[np.array(box.cells)].mean(axis=1)[:, 2].round().astype(int)})
rm = hf.Remesher(mesh, goal=15, trigger=10, transfer={"T": "linear", "material": "inherit"})
points, n_changed = rm.points, 0
for i in range(25):
    step = rm.step(motion(points, 0.15))
    points = rm.points
    if step.changed:  # else a solver keeps its matrix, its preconditioner, everything
        n_changed += 1
        print(f"step {i}: {step.edits}")
    assert step.inverted == 0
print(f"{n_changed} of 25 steps changed the mesh; {rm}; error of T: {abs(rm.field('T') - points[:, 2]).max():.1e}")
assert 1 < n_changed < 25
