// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <hfremesh/HalfFace/Circulators.hh>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/Remesh/Improve.hh>
#include <iostream>

int main() {
  // Points and cells as a simulation leaves them: here a cube, deformed until 48 of its cells are inverted.
  hfr::generate::Arrays moved = hfr::generate::cavity();
  hfr::TetMesh mesh = hfr::build(moved.points, moved.cells);

  const hfr::Result result = hfr::improve(mesh);
  std::cout << result.before.inverted.size() << " inverted cells before, " << result.invalid_cells.size()
            << " after; smallest angle now " << result.after.min_dihedral.min << " degrees\n";

  // Half-faces: the cells round every edge, in order, without a table and without allocating.
  std::size_t longest = 0;
  for (hfr::EdgeHandle edge : mesh.edges()) {
    std::size_t round_edge = 0;
    for ([[maybe_unused]] hfr::CellHandle cell : mesh.edge_cells(edge)) ++round_edge;
    longest = std::max(longest, round_edge);
  }
  std::cout << "at most " << longest << " cells meet at an edge\n";
  return result.goal_reached ? 0 : 1;
}
