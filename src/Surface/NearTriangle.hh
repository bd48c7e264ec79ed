// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_NEAR_TRIANGLE_HH
#define HFR_SURFACE_NEAR_TRIANGLE_HH

#include <algorithm>
#include <array>
#include <cmath>

#include "HalfFace/Vec3.hh"
#include "Surface/InputSurface.hh"

namespace hfr {

/// A triangle that many points are asked of, whether they are near: its planes answer for most of them, and
/// only for what lies next to its rim the nearest point is looked for. O(1), allocates nothing.
class NearTriangle {
 public:
  explicit NearTriangle(const std::array<Vec3, 3>& triangle);

  /// Is x no further from the triangle than `distance`, which is not negative?
  bool is_within(Vec3 x, double distance) const {
    const double far = kMore * distance;
    const double height = std::abs(dot(normal_, x - corners_[0]));
    if (height > far) return false;
    double deepest = 0;  // how far x is beyond the edges
    for (std::size_t k = 0; k < 3; ++k) deepest = std::max(deepest, dot(outward_[k], x - corners_[k]));
    if (deepest > far) return false;
    if (deepest == 0 && has_planes_ && height <= kLess * distance) return true;
    return norm2(nearest_point(corners_, x) - x) <= distance * distance;
  }

 private:
  // Points whose distance differs by less from the one asked about are left to the exact question: rounding
  // must not matter.
  static constexpr double kMore = 1 + 1e-6;
  static constexpr double kLess = 1 - 1e-6;

  std::array<Vec3, 3> corners_;
  Vec3 normal_;  // length 1, as have those of outward_; 0 when the triangle is too thin for planes
  std::array<Vec3, 3> outward_;  // normal to edge k, from corner k to the next, in the triangle's plane
  bool has_planes_ = false;
};

}  // namespace hfr

#endif
