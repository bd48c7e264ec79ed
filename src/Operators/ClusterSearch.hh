// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_CLUSTER_SEARCH_HH
#define HFR_OPERATORS_CLUSTER_SEARCH_HH

#include <array>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/GrownCells.hh"
#include "Operators/Operator.hh"

namespace hfr {

/// The best cells on the points that are there: a cavity grows from a poor cell point by point, and after
/// each one a branch and bound over all ways to fill it looks for the one whose worst cell is best. It finds
/// what no sequence of swaps does, since on the way there some cell would be worse. Milliseconds a cell: for
/// those few that nothing cheaper mends. No vertex comes or goes, no constrained face vanishes.
template <class Metric>
struct ClusterSearch {
  static constexpr double kSeedNanoseconds = 1'000'000;
  static constexpr std::size_t kMaxPoints = 32;
  static constexpr std::size_t kMaxCreated = 96;  ///< cells; a filling with more is not found

  using Seed = CellSeed;  ///< a poor cell
  struct Plan : PlanBase {
    Seed seed;
    /// Corners of the new cells as numbers of the cavity's points, in the order in which its cells name them.
    std::array<std::array<std::uint8_t, 4>, kMaxCreated> created;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell
  /// A new worst value must be more than this many times the old one. The same cells with their corners in
  /// another order differ by rounding, which is no gain.
  double gain = 1.0 + 1e-9;
  std::size_t max_points = 20;   ///< of the cavity, at most kMaxPoints
  std::size_t max_nodes = 4000;  ///< branches looked into for one cavity
  const CutRim* rim = nullptr;   ///< where the mesh is cut out of a larger one

  /// The cell, or for the seed of a plan all that go.
  void scope(const TetMesh& mesh, const Seed& seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, const Seed& seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh& mesh, const Seed& seed) const;
};

}  // namespace hfr

#endif
