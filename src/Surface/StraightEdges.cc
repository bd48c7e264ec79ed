// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/StraightEdges.hh"

#include <algorithm>
#include <array>
#include <iterator>

namespace hfr::surface {

StraightEdges::StraightEdges(const Arrays& arrays, std::span<const Edge> edges, const PlaneFacets& facets,
                             double tolerance, const FaceStars& stars, std::span<const std::uint8_t> held)
    : arrays_(arrays),
      edges_(edges),
      facets_(facets),
      tolerance_(tolerance),
      stars_(stars),
      held_(held),
      rim_(arrays.points.size()) {
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    if (e.manifold && facets.number[e.f[0]] == facets.number[e.f[1]]) continue;
    for (VertexHandle v : {e.a, e.b}) rim_[v.idx()].push_back(i);
  }
}

std::vector<std::uint32_t> StraightEdges::unfold(std::span<const std::uint32_t> faces,
                                                 TrialPoints& points) const {
  const std::uint32_t facet = facets_.number[faces.front()];
  std::vector<VertexHandle> ends;
  for (std::uint32_t f : faces)
    std::ranges::copy_if(arrays_.faces[f], std::back_inserter(ends),
                         [&](VertexHandle v) { return !rim_[v.idx()].empty() && !slides(v); });
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<std::uint32_t> changed;
  for (VertexHandle v : ends) {
    for (std::uint32_t first : rim_[v.idx()]) {
      const Edge& e = edges_[first];
      const std::array<std::uint32_t, 2> sides = {facets_.number[e.f[0]], facets_.number[e.f[1]]};
      if (!e.manifold || std::ranges::find(sides, facet) == sides.end()) continue;
      const std::vector<VertexHandle> chain = chain_from(v, first);
      if (chain.size() < 3 || !(chain.front() < chain.back()) || !unfold(chain, points)) continue;
      changed.insert(changed.end(), sides.begin(), sides.end());
    }
  }
  std::ranges::sort(changed);
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  return changed;
}

/// Whether the vertex lies between two edges of the same two facets, which have all of its faces.
bool StraightEdges::slides(VertexHandle v) const {
  const auto& rim = rim_[v.idx()];
  if (held_[v.idx()] || rim.size() != 2) return false;
  std::array<std::array<std::uint32_t, 2>, 2> sides;
  for (std::size_t i = 0; i < 2; ++i) {
    const Edge& e = edges_[rim[i]];
    if (!e.manifold) return false;
    sides[i] = {facets_.number[e.f[0]], facets_.number[e.f[1]]};
    std::ranges::sort(sides[i]);
  }
  return sides[0] == sides[1] && std::ranges::all_of(stars_.at(v), [&](std::uint32_t f) {
           return std::ranges::find(sides[0], facets_.number[f]) != sides[0].end();
         });
}

/// From a vertex that does not slide over this edge to the next one.
std::vector<VertexHandle> StraightEdges::chain_from(VertexHandle v, std::uint32_t edge) const {
  std::vector<VertexHandle> chain = {v};
  for (;;) {
    const Edge& e = edges_[edge];
    const VertexHandle next = e.a == chain.back() ? e.b : e.a;
    chain.push_back(next);
    if (!slides(next)) return chain;
    const auto& rim = rim_[next.idx()];
    edge = rim[0] == edge ? rim[1] : rim[0];
  }
}

/// Spreads as few vertices as have half the room there that all of the edge would give them evenly; false
/// where none moves.
bool StraightEdges::unfold(const std::vector<VertexHandle>& chain, TrialPoints& points) const {
  const Vec3 origin = points.get()[chain.front().idx()];
  const Vec3 along = points.get()[chain.back().idx()] - origin;
  const double length = norm(along);
  const Vec3 axis = unit(along);
  std::vector<double> at;
  for (VertexHandle v : chain) {
    const Vec3 p = points.get()[v.idx()] - origin;
    at.push_back(dot(p, axis));
    if (!(norm(p - at.back() * axis) <= tolerance_)) return false;
  }
  const std::size_t last = chain.size() - 1;
  const double least = 0.5 * length / static_cast<double>(last);
  if (!(least > tolerance_)) return false;
  const std::vector<double> before = at;
  for (std::size_t i = 0; i < last; ++i) {
    if (at[i + 1] > at[i]) continue;
    std::size_t low = i, high = i + 1;
    const auto step = [&] { return (at[high] - at[low]) / static_cast<double>(high - low); };
    while ((low > 0 || high < last) && step() < least) {
      if (low > 0) --low;
      if (high < last) ++high;
    }
    const double gap = step(), from = at[low];
    for (std::size_t k = low + 1; k < high; ++k) at[k] = from + static_cast<double>(k - low) * gap;
    i = high - 1;  // what lies before has stayed in order
  }
  for (std::size_t i = 1; i < last; ++i)
    if (at[i] != before[i]) points.move(chain[i], (at[i] - before[i]) * axis);
  return at != before;
}

}  // namespace hfr::surface
