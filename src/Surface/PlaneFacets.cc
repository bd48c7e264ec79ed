// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/PlaneFacets.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace hfr::surface {

PlaneFacets grow_facets(const Arrays& arrays, std::span<const Edge> edges, double tolerance, Look look,
                        const std::function<bool(const Edge&)>& goes_over) {
  constexpr std::uint32_t kNone = ~0U;
  const std::size_t n = arrays.faces.size();
  std::vector<Vec3> normal(n);
  for (std::size_t i = 0; i < n; ++i) normal[i] = scaled_normal(corners(arrays.points, arrays.faces[i]));
  std::vector<std::array<std::uint32_t, 3>> across(n, {kNone, kNone, kNone});
  for (const Edge& e : edges)
    if (e.manifold && goes_over(e))
      for (std::size_t i = 0; i < 2; ++i) across[e.f[i]][e.k[i]] = e.f[1 - i];
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, std::ranges::greater(), [&](std::uint32_t f) { return norm2(normal[f]); });
  PlaneFacets facets;
  facets.number.assign(n, kNone);
  std::vector<std::uint32_t> front;
  for (std::uint32_t first : order) {
    if (facets.number[first] != kNone) continue;
    const auto number = static_cast<std::uint32_t>(facets.largest.size());
    facets.largest.push_back(first);
    facets.number[first] = number;
    const Vec3 anchor = arrays.points[arrays.faces[first][0].idx()], axis = unit(normal[first]);
    const auto is_in_plane = [&](VertexHandle v) {
      return std::abs(dot(arrays.points[v.idx()] - anchor, axis)) <= tolerance;
    };
    front.assign(1, first);
    while (!front.empty()) {
      const std::uint32_t f = front.back();
      front.pop_back();
      for (std::uint32_t g : across[f]) {
        if (g == kNone || facets.number[g] != kNone) continue;
        if (look == Look::kAlike && !(dot(normal[g], axis) > 0)) continue;
        if (!std::ranges::all_of(arrays.faces[g], is_in_plane)) continue;
        facets.number[g] = number;
        front.push_back(g);
      }
    }
  }
  return facets;
}

}  // namespace hfr::surface
