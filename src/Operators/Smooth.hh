// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_SMOOTH_HH
#define HFR_OPERATORS_SMOOTH_HH

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"

namespace hfr {

/// A better place for a vertex.
struct Move {
  Vec3 target;
  double old_worst = 0;  ///< smallest decision value in the star before
  double new_worst = 0;  ///< and after; > old_worst
};

/// What all smoothing operators share: seed, scope, cavity. `Search` finds the place:
/// std::optional<Move> search(mesh, v, link, metric, quality), where `link` holds the half-face opposite v of
/// each cell of the star, of any size, and `quality` the decision value per cell. As an operator of a round
/// it leaves a vertex of more than Star::kCapacity cells alone; smooth_pass() moves that, too.
template <class Search, class Metric>
struct Smooth {
  using Seed = VertexHandle;
  struct Plan : PlanBase {
    VertexHandle seed;
    Vec3 target;
  };

  Metric metric;
  std::span<const double> quality;       ///< decision value per cell
  std::span<const std::uint8_t> frozen;  ///< per vertex; see frozen_vertices()
  Search search{};

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const {
    Star star;
    out.clear();
    mesh.gather_star(seed, star);
    for (int i = 0; i < star.size; ++i) out.push_back(star.cells[static_cast<std::size_t>(i)]);
  }
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const {
    Star star;
    if (frozen[seed.idx()] || !mesh.gather_star(seed, star)) return std::nullopt;
    FixedVector<HalfFaceHandle, Star::kCapacity> link;
    for (std::size_t i = 0; i < static_cast<std::size_t>(star.size); ++i)
      link.push_back(halfface_of(star.cells[i], star.corners[i]));
    const std::optional<Move> move = search(mesh, seed, link, metric, quality);
    if (!move) return std::nullopt;
    Plan plan;
    plan.old_worst = move->old_worst;
    plan.new_worst = move->new_worst;
    plan.seed = seed;
    plan.target = move->target;
    return plan;
  }
  void cavity(const TetMesh&, const Plan& plan, Cavity& out) const {
    out.clear();
    out.moved = plan.seed;
    out.target = plan.target;
  }
  Tet identity(const TetMesh&, Seed seed) const {
    return {seed, VertexHandle(), VertexHandle(), VertexHandle()};
  }
};

/// Decision value of cell c with vertex v at x, its vertices in stored order.
template <class Metric>
double quality_with(const TetMesh& mesh, CellHandle c, VertexHandle v, Vec3 x, const Metric& metric) {
  const Cell& k = mesh.cell(c);
  const auto at = [&](std::size_t i) { return k.v[i] == v ? x : mesh.point(k.v[i]); };
  return metric(at(0), at(1), at(2), at(3));
}

/// Smallest quality_with over the star, or anything ≤ floor once it is no better.
template <class Metric>
double worst_with(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link, Vec3 x,
                  const Metric& metric, double floor) {
  double worst = std::numeric_limits<double>::infinity();
  for (HalfFaceHandle h : link) {
    const double q = quality_with(mesh, cell_of(h), v, x, metric);
    if (q < worst) worst = q;
    if (!(worst > floor)) return worst;
  }
  return worst;
}

/// Smallest cached quality of the star.
inline double worst_of(std::span<const HalfFaceHandle> link, std::span<const double> quality) {
  double worst = std::numeric_limits<double>::infinity();
  for (HalfFaceHandle h : link) {
    const double q = quality[cell_of(h).idx()];
    if (q < worst) worst = q;
  }
  return worst;
}

}  // namespace hfr

/// Instantiates the call of a smoothing search for the metrics that runs use.
#define HFR_INSTANTIATE_SEARCH_FOR(Search, Metric)                                                           \
  template std::optional<Move> Search::operator()(                                                           \
      const TetMesh&, VertexHandle, std::span<const HalfFaceHandle>, const Metric&, std::span<const double>) \
      const;
#define HFR_INSTANTIATE_SEARCH(Search)             \
  HFR_INSTANTIATE_SEARCH_FOR(Search, VolumeLength) \
  HFR_INSTANTIATE_SEARCH_FOR(Search, Untangling)   \
  HFR_INSTANTIATE_SEARCH_FOR(Search, MinSine2)     \
  HFR_INSTANTIATE_SEARCH_FOR(Search, MinDihedral)  \
  HFR_INSTANTIATE_SEARCH_FOR(Search, CustomMetric)

#endif
