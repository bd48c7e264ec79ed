// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/NearTriangle.hh"

#include <algorithm>

namespace hfr {

NearTriangle::NearTriangle(const std::array<Vec3, 3>& triangle) : corners_(triangle) {
  constexpr double kThin = 1e-5;  // height over the longest edge, below which rounding tilts the planes
  const auto edge = [&](std::size_t k) { return corners_[(k + 1) % 3] - corners_[k]; };
  const Vec3 across = cross(edge(0), corners_[2] - corners_[0]);
  const double area = norm(across);
  const double longest2 = std::max({norm2(edge(0)), norm2(edge(1)), norm2(edge(2))});
  has_planes_ = area > kThin * longest2;
  if (!has_planes_) return;
  normal_ = (1.0 / area) * across;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 out = cross(edge(k), normal_);
    outward_[k] = (1.0 / norm(out)) * out;
  }
}

}  // namespace hfr
