// SPDX-License-Identifier: BSD-3-Clause
#include "Raster.hh"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hfr::view {
namespace {

constexpr float kNothing = -std::numeric_limits<float>::infinity();
constexpr double kNoEdges = 2, kAllEdges = 9;  // heights of a triangle in pixels, between which edges fade in

/// Over the edge opposite each corner, in pixels; 0 for a triangle without area.
std::array<double, 3> heights(const std::array<std::array<double, 3>, 3>& p) {
  const double area =
      std::abs((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]));
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto &a = p[(i + 1) % 3], &b = p[(i + 2) % 3];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    out[i] = length > 0 ? area / length : 0;
  }
  return out;
}

}  // namespace

double lowest_height(const std::array<std::array<double, 3>, 3>& corners) {
  const std::array<double, 3> height = heights(corners);
  return *std::min_element(height.begin(), height.end());
}

Raster::Raster(int width, int height) : width_(kSamples * width), height_(kSamples * height) {
  const std::size_t n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  depth_.assign(n, kNothing);
  opacity_.assign(n, 0);
  colour_.resize(n);
}

void Raster::triangle(const std::array<std::array<double, 3>, 3>& corners, Colour colour,
                      const EdgeStyle& edges) {
  std::array<std::array<double, 3>, 3> p = corners;
  for (auto& corner : p) {
    corner[0] *= kSamples;
    corner[1] *= kSamples;
  }
  const double area =
      (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);  // twice
  if (!(std::abs(area) > 1e-9)) return;
  const std::array<double, 3> height = heights(corners);
  const double lowest = *std::min_element(height.begin(), height.end());
  const float edge_opacity =
      edges.opacity * static_cast<float>(std::clamp((lowest - kNoEdges) / (kAllEdges - kNoEdges), 0.0, 1.0));
  const auto range = [](double a, double b, double c, int n) {
    const double low = std::min({a, b, c}), high = std::max({a, b, c});
    return std::array<int, 2>{static_cast<int>(std::clamp(std::floor(low), 0.0, static_cast<double>(n))),
                              static_cast<int>(std::clamp(std::ceil(high), 0.0, static_cast<double>(n)))};
  };
  const auto [x_begin, x_end] = range(p[0][0], p[1][0], p[2][0], width_);
  const auto [y_begin, y_end] = range(p[0][1], p[1][1], p[2][1], height_);
  for (int y = y_begin; y < y_end; ++y)
    for (int x = x_begin; x < x_end; ++x) {
      const double sx = x + 0.5, sy = y + 0.5;
      const double w1 = ((sx - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (sy - p[0][1])) / area;
      const double w2 = ((p[1][0] - p[0][0]) * (sy - p[0][1]) - (sx - p[0][0]) * (p[1][1] - p[0][1])) / area;
      const double w0 = 1 - w1 - w2;
      if (w0 < 0 || w1 < 0 || w2 < 0) continue;
      const auto depth = static_cast<float>(w0 * p[0][2] + w1 * p[1][2] + w2 * p[2][2]);
      const std::size_t at = index(x, y);
      if (depth <= depth_[at]) continue;
      depth_[at] = depth;
      opacity_[at] = 1;
      const double to_edge = std::min({w0 * height[0], w1 * height[1], w2 * height[2]});
      colour_[at] = 2 * to_edge < edges.thickness ? mix(colour, edges.colour, edge_opacity) : colour;
    }
}

void Raster::overlay(const Raster& other, float opacity, bool in_front) {
  for (std::size_t i = 0; i < depth_.size(); ++i) {
    const float over = opacity * other.opacity_[i];
    if (over <= 0 || (in_front && other.depth_[i] <= depth_[i])) continue;
    const float under = opacity_[i] * (1 - over);
    colour_[i] = mix(colour_[i], other.colour_[i], over / (over + under));
    opacity_[i] = over + under;
  }
}

void Raster::resolve(Canvas& canvas, int left, int top) const {
  constexpr float kShare = 1.0F / (kSamples * kSamples);
  for (int y = 0; y < height_ / kSamples; ++y)
    for (int x = 0; x < width_ / kSamples; ++x) {
      float opacity = 0;
      Colour sum;
      for (int sy = 0; sy < kSamples; ++sy)
        for (int sx = 0; sx < kSamples; ++sx) {
          const std::size_t at = index(kSamples * x + sx, kSamples * y + sy);
          const float weight = opacity_[at];
          opacity += weight;
          sum = {sum.r + weight * colour_[at].r, sum.g + weight * colour_[at].g,
                 sum.b + weight * colour_[at].b};
        }
      if (opacity <= 0) continue;
      canvas.blend(left + x, top + y, {sum.r / opacity, sum.g / opacity, sum.b / opacity}, opacity * kShare);
    }
}

}  // namespace hfr::view
