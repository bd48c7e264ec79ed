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

/// First places of a seed are numbered: the middle of the cell, of its faces, of its edges, and four over
/// each constrained face. Those of one such face are one part, since they are found together.
constexpr std::size_t kFirstParts = 1 + 4 + 6 + 4;

/// Digs from the first places that belong to one part; where there is none, the site stays what it is.
template <class Metric, class Sites>
void dig_first(const TetMesh& mesh, CellHandle c, std::size_t part, const detail::Digger<Metric>& digger,
               Sites& sites) {
  GrownCells cells(mesh, c);
  const auto at = [&](std::size_t i) { return mesh.point(mesh.cell(c).v[i]); };
  if (part == 0) {
    sites[part] = digger.dig(cells, 0.25 * ((at(0) + at(1)) + (at(2) + at(3))));
  } else if (part < 5) {
    const HalfFaceHandle h = halfface_of(c, static_cast<int>(part - 1));
    if (!cells.grow(h)) return;
    const auto p = detail::points_of(mesh, h);
    sites[part] = digger.dig(cells, (1.0 / 3.0) * ((p[0] + p[1]) + p[2]));
  } else if (part < 11) {
    HalfFaceHandle behind;  // which the next cell lies
    const bool inside =
        mesh.walk_ring(c, static_cast<int>(part - 5), [&](CellHandle d, VertexHandle p, VertexHandle) {
          if (behind.is_valid() && !cells.grow(behind)) return false;
          behind = mesh.ring_exit(d, p);
          return true;
        });
    const auto& ends = kEdgeCorners[part - 5];
    if (inside) sites[part] = digger.dig(cells, 0.5 * (at(ends[0]) + at(ends[1])));
  } else {
    const HalfFaceHandle h = halfface_of(c, static_cast<int>(part - 11));
    if (!mesh.is_constrained(h)) return;
    const auto places = places_above<Metric>(detail::points_of(mesh, h));
    for (std::size_t i = 0; i < places.size(); ++i)
      sites[11 + 4 * (part - 11) + i] = digger.dig(cells, places[i]);
  }
}

}  // namespace

template <class Metric>
void VertexInsertion<Metric>::scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
  seed.growth.cells(mesh, out);
}

template <class Metric>
auto VertexInsertion<Metric>::evaluate(const TetMesh& mesh, const Seed& seed) const -> std::optional<Plan> {
  return evaluate_in_turn(*this, mesh, seed);
}

template <class Metric>
std::size_t VertexInsertion<Metric>::n_parts(Parts& parts, int step) const {
  if (only_place) return step == 0 ? 1 : 0;
  if (step == 0) return kFirstParts;
  if (step > 1) return 0;
  const auto& sites = parts.sites;
  std::array<std::uint8_t, kMaxSites> order;
  std::iota(order.begin(), order.end(), std::uint8_t{0});
  std::sort(order.begin(), order.end(), [&](std::uint8_t i, std::uint8_t j) {
    return sites[i].new_worst != sites[j].new_worst ? sites[i].new_worst > sites[j].new_worst : i < j;
  });
  for (std::size_t i = 0; i < std::min(max_sites, kMaxSites); ++i) {
    if (only_site >= 0 && i != static_cast<std::size_t>(only_site)) continue;
    const detail::Site& start = sites[order[i]];
    if (start.new_worst > 0 && start.new_worst >= least_promise * gain * start.old_worst)
      parts.followed.push_back(order[i]);
  }
  return parts.followed.size();
}

template <class Metric>
void VertexInsertion<Metric>::evaluate_part(const TetMesh& mesh, Parts& parts, int step,
                                            std::size_t part) const {
  const detail::Digger<Metric> digger(mesh, metric, quality, max_cells, parts.seed.cell, {}, rim);
  if (only_place) {
    detail::Site& site = parts.sites[0];
    site = digger.dig(GrownCells(mesh, parts.seed.cell), *only_place);
    if (site.new_worst > gain * site.old_worst) parts.followed.push_back(0);
    return;
  }
  if (step == 0) return dig_first(mesh, parts.seed.cell, part, digger, parts.sites);
  detail::Site& site = parts.sites[parts.followed[part]];
  site = digger.follow_up(site, kMaxDigs, leaves_early ? gain : 0.0);
  const double least = gain < 1 ? gain * site.old_worst : std::max(gain * site.old_worst, site.old_worst);
  if (!(site.new_worst > least) || multiplies_poor(mesh, *this, site)) site.new_worst = -HFR_INFINITY;
}

template <class Metric>
auto VertexInsertion<Metric>::plan(const TetMesh& mesh, const Parts& parts) const -> std::optional<Plan> {
  const detail::Site* best = nullptr;
  for (std::uint8_t i : parts.followed) {
    const detail::Site& site = parts.sites[i];
    // Smaller inverted cells would look better in some metrics, and be cut again without end.
    if (site.new_worst > (best ? best->new_worst : 0)) best = &site;
  }
  if (!best) return std::nullopt;
  return detail::plan_for(*this, mesh, parts.seed, *best);
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
