// SPDX-License-Identifier: BSD-3-Clause
// Klingner & Shewchuk, Aggressive tetrahedral mesh improvement, 2007: their insertion.
#include "Operators/VertexInsertion.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "Operators/Dig.hh"
#include "Operators/MaxMinForm.hh"
#include "Operators/Metrics.hh"
#include "Operators/Needle.hh"

namespace hfr {
namespace {

constexpr int kMaxDigs = 4;                                     // with a move of the new vertex after each
constexpr std::array<double, 3> kAlongAxis = {0.15, 0.3, 0.5};  // places over a constrained face

/// Places from which the cell on a triangle (corners in the order that a cell on it has) has a good smallest
/// dihedral: the best one, and some between the shortest side and the corner across, for needles.
template <class Metric>
std::array<Vec3, 4> places_above(const std::array<Vec3, 3>& p) {
  const detail::Needle needle(p);
  MaxMinForm form(needle.middle, MaxMinForm::kAnglesOf<Metric>);
  form.add(p[0], p[1], p[2]);
  std::array<Vec3, 4> places = {
      form.ascend(needle.middle + (0.8 * needle.side) * needle.up, detail::kAscent)};
  for (std::size_t i = 0; i < kAlongAxis.size(); ++i) places[i + 1] = needle.place(kAlongAxis[i]);
  return places;
}

/// Whether the cells that come number more below op.poor_below than those that go, by more than is allowed.
template <class Metric>
bool multiplies_poor(const TetMesh& mesh, const VertexInsertion<Metric>& op, const detail::Site& site) {
  if (!(op.poor_below > 0)) return false;
  Cavity cavity;
  detail::fill_cavity(mesh, site.growth, site.place, cavity);
  const auto point = [&](VertexHandle v) { return v == Cavity::kNewVertex ? site.place : mesh.point(v); };
  const auto n_removed = std::count_if(cavity.removed.begin(), cavity.removed.end(),
                                       [&](CellHandle c) { return op.quality[c.idx()] < op.poor_below; });
  const auto n_created = std::count_if(cavity.created.begin(), cavity.created.end(), [&](const Tet& t) {
    return op.metric(point(t[0]), point(t[1]), point(t[2]), point(t[3])) < op.poor_below;
  });
  return n_created > n_removed + VertexInsertion<Metric>::kMorePoor;
}

}  // namespace

template <class Metric>
void VertexInsertion<Metric>::scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
  seed.growth.cells(mesh, out);
}

template <class Metric>
auto VertexInsertion<Metric>::evaluate(const TetMesh& mesh, const Seed& seed) const -> std::optional<Plan> {
  const detail::Digger<Metric> digger(mesh, metric, quality, max_cells);
  if (only_place) {
    const detail::Site site = digger.dig(GrownCells(mesh, seed.cell), *only_place);
    if (!(site.new_worst > 0 && site.new_worst > gain * site.old_worst)) return std::nullopt;
    return detail::plan_for(*this, mesh, seed, site);
  }
  FixedVector<detail::Site, kMaxSites> sites;
  const auto try_from = [&](const GrownCells& cells, Vec3 place) {
    sites.push_back(digger.dig(cells, place));
  };
  const Cell& cell = mesh.cell(seed.cell);
  const GrownCells alone(mesh, seed.cell);
  const auto at = [&](std::size_t i) { return mesh.point(cell.v[i]); };
  try_from(alone, 0.25 * ((at(0) + at(1)) + (at(2) + at(3))));
  for (int k = 0; k < 4; ++k) {
    GrownCells pair = alone;
    if (!pair.grow(halfface_of(seed.cell, k))) continue;
    const auto f = mesh.halfface_vertices(halfface_of(seed.cell, k));
    try_from(pair, (1.0 / 3.0) * ((mesh.point(f[0]) + mesh.point(f[1])) + mesh.point(f[2])));
  }
  for (int e = 0; e < 6; ++e) {
    GrownCells ring = alone;
    HalfFaceHandle behind;  // which the next cell lies
    const bool inside = mesh.walk_ring(seed.cell, e, [&](CellHandle c, VertexHandle p, VertexHandle) {
      if (behind.is_valid() && !ring.grow(behind)) return false;
      behind = mesh.ring_exit(c, p);
      return true;
    });
    const auto& ends = kEdgeCorners[static_cast<std::size_t>(e)];
    if (inside) try_from(ring, 0.5 * (at(ends[0]) + at(ends[1])));
  }
  for (int k = 0; k < 4; ++k) {
    const HalfFaceHandle h = halfface_of(seed.cell, k);
    if (mesh.is_constrained(h))
      for (Vec3 place : places_above<Metric>(detail::points_of(mesh, h))) try_from(alone, place);
  }
  std::array<std::uint8_t, kMaxSites> order;
  const auto last = order.begin() + static_cast<std::ptrdiff_t>(sites.size());
  std::iota(order.begin(), last, std::uint8_t{0});
  std::sort(order.begin(), last, [&](std::uint8_t i, std::uint8_t j) {
    return sites[i].new_worst != sites[j].new_worst ? sites[i].new_worst > sites[j].new_worst : i < j;
  });
  detail::Site best;
  for (std::size_t i = 0; i < std::min(max_sites, sites.size()); ++i) {
    if (only_site >= 0 && i != static_cast<std::size_t>(only_site)) continue;
    const detail::Site& start = sites[order[i]];
    if (start.new_worst < least_promise * gain * start.old_worst) continue;
    const detail::Site site = digger.follow_up(start, kMaxDigs);
    const double least = gain < 1 ? gain * site.old_worst : std::max(gain * site.old_worst, site.old_worst);
    if (site.new_worst > best.new_worst && site.new_worst > least && !multiplies_poor(mesh, *this, site))
      best = site;
  }
  // Smaller inverted cells would look better in some metrics, and be cut again without end.
  if (!(best.new_worst > 0)) return std::nullopt;
  return detail::plan_for(*this, mesh, seed, best);
}

template <class Metric>
void VertexInsertion<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  detail::fill_cavity(mesh, plan.seed.growth, plan.place, out);
}

template <class Metric>
Tet VertexInsertion<Metric>::identity(const TetMesh& mesh, const Seed& seed) const {
  Tet names = mesh.cell(seed.cell).v;
  std::sort(names.begin(), names.end());
  return names;
}

HFR_INSTANTIATE_FOR_METRICS(VertexInsertion)

}  // namespace hfr
