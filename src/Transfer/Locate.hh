// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_LOCATE_HH
#define HFR_TRANSFER_LOCATE_HH

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// Where a point lies in a mesh. `weights`: its barycentric coordinates in the cell, which add up to 1.
struct Place {
  CellHandle cell;  ///< invalid where there is no cell with a volume near
  std::array<double, 4> weights{};
  bool inside = false;  ///< in the cell or on its surface, up to rounding; otherwise beyond the mesh
};

/// Where a mesh ends that is a part of a larger one.
struct CutFaces {
  std::span<const std::uint8_t> is_cut;  ///< by half-face without a mate: whether the mesh goes on there
  /// Those that a search came to and could not go through: unless there are none, it has to be made again
  /// with what is behind them.
  std::vector<HalfFaceHandle> met = {};
};

/// Looks for the point from these cells on, those round an old vertex near it, ascending: a walk from
/// half-face to half-face. Where that ends at the boundary or goes round an inverted cell, the cells round
/// about, a layer after the other, until one has the point or nothing nearer was found; then the place is in
/// the cell that it is least outside of. Works from what it is given alone: the result does not depend on
/// other searches, nor on how the mesh is stored. `cut`: of a mesh that is a part.
Place locate(const TetMesh& mesh, Vec3 point, std::span<const CellHandle> star, CutFaces* cut = nullptr);

}  // namespace hfr

#endif
