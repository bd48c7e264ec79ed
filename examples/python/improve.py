# SPDX-License-Identifier: BSD-3-Clause
"""Arrays in, repaired arrays out. Runs as it is: python improve.py"""

import numpy as np

import hfremesh as hf

# Points and cells as a simulation leaves them: a cube, deformed until cells are inverted.
moved = hf.generate.cavity((8, 9, 10))
points, cells = np.array(moved.points), np.array(moved.cells)
temperature = points @ [1.0, 2.0, 3.0]

print("inverted cells:", hf.stats(points, cells).inverted)
r = hf.improve(points, cells, min_dihedral=15, fields={"T": temperature}, transfer={"T": "linear"})
print(f"{r.before.inverted} inverted before, {r.after.inverted} after; smallest angle {r.after.min_dihedral:.2f}")
print(f"{len(r.edits.created_cells)} of {len(r.cells)} cells are new; error of T:",
      float(abs(r.fields["T"] - r.points @ [1.0, 2.0, 3.0]).max()))

# The result, or any other mesh, has walks that arrays do not have.
print("cells round the first edge:", r.mesh.edge_cells(r.mesh.edges[0]))
assert r.goal_reached and hf.check(r.mesh)
