// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_RASTER_HH
#define HFR_APPS_REPORT_RASTER_HH

#include <array>
#include <vector>

#include "Canvas.hh"

namespace hfr::view {

/// How the three edges of a triangle are drawn on it.
struct EdgeStyle {
  Colour colour = {};
  float opacity = 0;
  double thickness = 1;  ///< pixels; each of two neighbours draws half of it
};

/// The lowest of the three heights of a triangle, in pixels; the third coordinate does not count.
double lowest_height(const std::array<std::array<double, 3>, 3>& corners);

/// Triangles with a depth buffer, kSamples x kSamples samples a pixel.
class Raster {
 public:
  static constexpr int kSamples = 3;

  Raster(int width, int height);

  /// Corners in pixels, with a depth that is larger for what is nearer. Edges fade out on triangles of few
  /// pixels, which would be nothing but edges.
  void triangle(const std::array<std::array<double, 3>, 3>& corners, Colour colour, const EdgeStyle& edges);
  /// Lays another raster of that size over this one; `in_front`: only where it is nearer.
  void overlay(const Raster& other, float opacity, bool in_front);
  /// Onto a canvas, with its upper left corner at (left, top).
  void resolve(Canvas& canvas, int left, int top) const;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_, height_;  ///< in samples
  std::vector<float> depth_;
  std::vector<float> opacity_;
  std::vector<Colour> colour_;
};

}  // namespace hfr::view

#endif
