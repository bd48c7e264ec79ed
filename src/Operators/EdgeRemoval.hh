// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_EDGE_REMOVAL_HH
#define HFR_OPERATORS_EDGE_REMOVAL_HH

#include <array>
#include <optional>
#include <span>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Operators/Operator.hh"

namespace hfr {

/// Edge removal: replaces the n cells round an inner edge (a, b) by the 2(n-2) cells that a triangulation of
/// the ring makes with a and with b. All triangulations are searched (Klincsek's programme), so that the
/// result is the best there is; it contains the paper's EDGE operator, whose star forms are the fans.
template <class Metric>
struct EdgeRemoval {
  static constexpr double kSeedNanoseconds = 2'000;
  static constexpr int kMaxRing = 32;  ///< larger rings are left alone

  using Seed = EdgeHandle;  ///< 6·cell + local edge, of any cell of the ring
  struct Plan : PlanBase {
    EdgeHandle seed;
    std::uint8_t ring = 0;
    /// Middle ring vertex of each triangle of the best triangulation, in preorder from the side (0, ring-1).
    std::array<std::uint8_t, kMaxRing - 2> apex;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh& mesh, Seed seed) const;
};

}  // namespace hfr

#endif
