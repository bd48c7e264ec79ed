// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_FAN_MERGE_HH
#define HFR_OPERATORS_FAN_MERGE_HH

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"

namespace hfr {

/// Edge removal for edges that have to stay: k cells in a row round an edge (a, b) become one cell there, and
/// 2(k-1) above and below it that a triangulation of their outer vertices makes with a and with b. On the
/// boundary, and on each side of an interface or a labelled face, the row stays between the faces that may
/// not change; round an inner edge it is a part of the ring. Of all rows that hold the seed's cell and all
/// triangulations the best is taken. With k = 2 it would be the 2-3 swap, which is left to FaceSwap.
template <class Metric>
struct FanMerge {
  static constexpr int kReach = 6;  ///< cells on either side of the seed's that are looked at
  static constexpr int kMaxCells = 2 * kReach + 1;

  /// Local edge `edge` of a cell. The seed of a plan also says how many cells before and after it go, counted
  /// counter-clockwise about the edge.
  struct Seed {
    CellHandle cell;
    std::uint8_t edge = 0;
    std::uint8_t n_before = 0;
    std::uint8_t n_after = 0;
  };
  struct Plan : PlanBase {
    Seed seed;
    /// Middle vertex of each triangle, in preorder from the side between the first and the last.
    std::array<std::uint8_t, kMaxCells - 1> apex;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell

  /// The cell, or for the seed of a plan all that go.
  void scope(const TetMesh& mesh, const Seed& seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, const Seed& seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  /// The corners of the cell that comes to the edge.
  Tet identity(const TetMesh& mesh, const Seed& seed) const;
};

}  // namespace hfr

#endif
