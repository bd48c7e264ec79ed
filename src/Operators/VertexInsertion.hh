// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_VERTEX_INSERTION_HH
#define HFR_OPERATORS_VERTEX_INSERTION_HH

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/GrownCells.hh"
#include "Operators/Operator.hh"

namespace hfr {

/// A new vertex in or near a poor cell. From several places (the middles of the cell, of its inner faces and
/// of its inner edges, and where a cell on one of its outer faces would be good) a cavity is dug: always
/// behind the outer face that makes the worst cell with the new vertex. The best cavity on the way is kept,
/// the vertex moved to where the smallest dihedral of its cells is largest, and the digging goes on from
/// there. Expensive, and it adds cells: for those few that nothing else mends. No face that is constrained
/// vanishes, and no vertex.
template <class Metric>
struct VertexInsertion {
  static constexpr double kSeedNanoseconds = 200'000;
  /// With none or one, the worst angles end lower on the test meshes, with three, the percentiles.
  static constexpr int kMorePoor = 2;
  static constexpr std::size_t kMaxSites = 1 + 4 + 6 + 16;
  using Seed = CellSeed;  ///< a poor cell
  struct Plan : PlanBase {
    Seed seed;
    Vec3 place;
  };
  /// An evaluation, step by step: cavities dug from the first places, then the most promising ones followed
  /// up. See EvaluatesInParts.
  struct Parts {
    explicit Parts(const Seed& s) : seed(s) {}

    Seed seed;
    std::array<detail::Site, kMaxSites> sites;      ///< by number of the first place
    FixedVector<std::uint8_t, kMaxSites> followed;  ///< numbers of those that are followed up, in turn
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell
  /// A new worst value must be more than this many times the old one. Less than 1: it may be worse by that
  /// much, for callers that go on from there and take it back if nothing comes of it.
  double gain = 1.0;
  std::size_t max_sites = kMaxSites;  ///< first places that are followed up, the most promising ones
  /// Share of the worst value asked for that a first place must come to by itself to be followed up.
  double least_promise = 0;
  /// Leaves a place that a move of the vertex does not bring to the gain, unless as much again would.
  bool leaves_early = false;
  /// Where positive, a new vertex may make at most kMorePoor cells more that are below it than there were.
  /// One that only raised the worst of its cells would leave several poor ones in the place of one.
  double poor_below = 0;
  int only_site = -1;  ///< not negative: only this one of them, counted by promise from 0
  /// Where there is one, the cavity is dug from the seed's cell for a vertex at this place, which stays
  /// there; max_sites, least_promise, poor_below and only_site do not matter then.
  std::optional<Vec3> only_place = std::nullopt;
  std::size_t max_cells = 48;   ///< of the cavity, at most Growth::kMaxCells
  const CutRim* rim = nullptr;  ///< where the mesh is cut out of a larger one

  /// The cell, or for the seed of a plan all that go.
  void scope(const TetMesh& mesh, const Seed& seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, const Seed& seed) const;
  std::size_t n_parts(Parts& parts, int step) const;
  void evaluate_part(const TetMesh& mesh, Parts& parts, int step, std::size_t part) const;
  std::optional<Plan> plan(const TetMesh& mesh, const Parts& parts) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh& mesh, const Seed& seed) const;
};

}  // namespace hfr

#endif
