// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceLayers.hh"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hfr::surface {
namespace {

/// Cosine of the least angle to the layers' sum at which a triangle lies against them.
constexpr double kAgainst = -0.2;
/// The layers look one way where their area vectors add up to more than this share of their areas.
constexpr double kOneSided = 0.2;
/// There is one layer where the areas come to no more than this times the length of their vectors' sum.
constexpr double kOneLayer = 1.6;
/// Samples along an edge that is as long as the reach, and along any edge at most.
constexpr double kCuts = 3;
constexpr double kMostCuts = 24;

Vec3 middle(const Triangle& t) { return (1.0 / 3.0) * (t[0] + t[1] + t[2]); }

}  // namespace

SurfaceLayers::SurfaceLayers(const Arrays& arrays, std::span<const Vec3> points, double reach,
                             std::span<const std::uint32_t> near)
    : reach_(reach) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 high{-kFar, -kFar, -kFar};
  low_ = {kFar, kFar, kFar};
  for (std::uint32_t f : near)
    for (VertexHandle v : arrays.faces[f])
      for (int d = 0; d < 3; ++d) {
        low_[d] = std::min(low_[d], points[v.idx()][d] - reach);
        high[d] = std::max(high[d], points[v.idx()][d] + reach);
      }
  for (const auto& f : arrays.faces) {
    const Triangle t = corners(points, f);
    bool outside = false;
    for (int d = 0; d < 3; ++d)
      outside = outside || std::max({t[0][d], t[1][d], t[2][d]}) < low_[d] ||
                std::min({t[0][d], t[1][d], t[2][d]}) > high[d];
    if (!outside) add(t);
  }
  std::stable_sort(samples_.begin(), samples_.end(),
                   [](const Sample& a, const Sample& b) { return a.box < b.box; });
}

/// A triangle is taken in as samples, in the middles of its equal parts.
void SurfaceLayers::add(const Triangle& t) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, norm(t[(k + 1) % 3] - t[k]));
  const double n = std::clamp(std::ceil(kCuts * longest / reach_), 1.0, kMostCuts);
  const Vec3 u = (1 / n) * (t[1] - t[0]);
  const Vec3 v = (1 / n) * (t[2] - t[0]);
  const Vec3 area = (1 / (n * n)) * scaled_normal(t);
  const auto put = [&](double i, double j) {
    const Vec3 x = t[0] + i * u + j * v;
    samples_.push_back({box_of(x), x, area});
  };
  for (double i = 0; i < n; ++i)
    for (double j = 0; i + j < n; ++j) {
      put(i + 1.0 / 3.0, j + 1.0 / 3.0);
      if (i + j + 1 < n) put(i + 2.0 / 3.0, j + 2.0 / 3.0);
    }
}

SurfaceLayers::Box SurfaceLayers::box_of(Vec3 x) const {
  const auto along = [&](int d) { return static_cast<int>(std::floor((x[d] - low_[d]) / reach_)); };
  return {along(0), along(1), along(2)};
}

SurfaceLayers::View SurfaceLayers::view(Vec3 x) const {
  View view;
  const Box box = box_of(x);
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const Box from{box[0] + i, box[1] + j, box[2] - 1};
      const Box to{box[0] + i, box[1] + j, box[2] + 1};
      auto at = std::lower_bound(samples_.begin(), samples_.end(), from,
                                 [](const Sample& s, const Box& b) { return s.box < b; });
      for (; at != samples_.end() && at->box <= to; ++at) {
        const Vec3 apart = at->place - x;
        const double share = 1 - dot(apart, apart) / (reach_ * reach_);
        if (!(share > 0)) continue;
        view.sum = view.sum + (share * share) * at->area;
        view.total += share * share * norm(at->area);
      }
    }
  }
  return view;
}

Vec3 SurfaceLayers::outward(Vec3 x) const { return unit(view(x).sum); }

bool SurfaceLayers::against(const Triangle& t) const {
  const View round = view(middle(t));
  const double length = norm(round.sum);
  const Vec3 normal = scaled_normal(t);
  return length > kOneSided * round.total && dot(normal, round.sum) < kAgainst * norm(normal) * length;
}

bool SurfaceLayers::covered(const Triangle& t) const {
  const View round = view(middle(t));
  return round.total > kOneLayer * norm(round.sum);
}

}  // namespace hfr::surface
