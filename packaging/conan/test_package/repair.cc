// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <hfremesh/HalfFace/Generate.hh>
#include <hfremesh/IO/ReadWrite.hh>
#include <hfremesh/Remesh/Improve.hh>
#include <iostream>

/// Repairs a mesh, writes it in the format that links the most libraries, and reads it again.
int main() {
  const hfr::generate::Arrays moved = hfr::generate::cavity();
  hfr::TetMesh mesh = hfr::build(moved.points, moved.cells);
  const hfr::Result result = hfr::improve(mesh);
  hfr::io::write("repaired.vtu", mesh);
  const std::size_t n_read = hfr::io::read("repaired.vtu").n_cells();
  std::cout << "hfremesh " << HFR_VERSION << ": " << result.before.inverted.size()
            << " inverted cells before, " << result.invalid_cells.size() << " after; " << n_read
            << " cells read again\n";
  return result.goal_reached && n_read == mesh.n_cells() ? 0 : 1;
}
