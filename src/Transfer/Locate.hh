// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_LOCATE_HH
#define HFR_TRANSFER_LOCATE_HH

#include <array>
#include <cstdint>
#include <span>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// Where a point lies in a mesh. `weights`: its barycentric coordinates in the cell, which add up to 1.
struct Place {
  CellHandle cell;  ///< invalid where there is no cell with a volume near
  std::array<double, 4> weights{};
  bool inside = false;  ///< in the cell or on its surface, up to rounding; otherwise beyond the mesh
  /// Invalid, or a face that the search came to and behind which there is more of the mesh that is not here:
  /// then all else says nothing.
  HalfFaceHandle cut;
};

/// Looks for the point from these cells on, those round an old vertex near it, ascending: a walk from
/// half-face to half-face. Where that ends at the boundary or goes round an inverted cell, the cells round
/// about, a layer after the other, until one has the point or nothing nearer was found; then the place is in
/// the cell that it is least outside of. Works from what it is given alone: the result does not depend on
/// other searches, nor on how the mesh is stored. `is_cut`: by half-face without a mate, whether the mesh
/// goes on there; empty: nowhere.
Place locate(const TetMesh& mesh, Vec3 point, std::span<const CellHandle> star,
             std::span<const std::uint8_t> is_cut = {});

}  // namespace hfr

#endif
