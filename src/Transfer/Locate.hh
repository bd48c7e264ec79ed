// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_LOCATE_HH
#define HFR_TRANSFER_LOCATE_HH

#include <array>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// Where a point lies in a mesh. `weights`: its barycentric coordinates in the cell, which add up to 1.
struct Place {
  CellHandle cell;  ///< invalid where there is no cell with a volume near
  std::array<double, 4> weights{};
  bool inside = false;  ///< in the cell or on its surface, up to rounding; otherwise beyond the mesh
};

/// Looks for the point from the cells of vertex `near` on: a walk from half-face to half-face. Where that
/// ends at the boundary or goes round an inverted cell, the cells round about, a layer after the other, until
/// one has the point or nothing nearer was found; then the place is in the cell that it is least outside of.
/// Works from what it is given alone: the result does not depend on other searches.
Place locate(const TetMesh& mesh, Vec3 point, VertexHandle near);

}  // namespace hfr

#endif
