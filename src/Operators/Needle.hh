// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_NEEDLE_HH
#define HFR_OPERATORS_NEEDLE_HH

#include <array>
#include <cmath>
#include <cstddef>

#include "HalfFace/TetMesh.hh"

// For the sources of operators and passes only: not installed.
namespace hfr::detail {

/// The corners of a half-face, in the order of halfface_vertices().
inline std::array<Vec3, 3> points_of(const TetMesh& mesh, HalfFaceHandle h) {
  const auto v = mesh.halfface_vertices(h);
  return {mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2])};
}

/// A triangle as one short side and the corner across, as a long face of a surface is. With short side s and
/// length l, an apex at the share t of the way to the tip and at height y makes about the angle y/(t l) at
/// the short side and (1-t) s/y at the edge to the tip, alike where y² = t(1-t) s l.
struct Needle {
  Vec3 middle;  ///< of the shortest side
  Vec3 axis;    ///< from there to the tip
  Vec3 up;      ///< unit normal to the side from which the corners turn left; zero where they lie in a line
  double side = 0;
  double length = 0;  ///< of the axis

  explicit Needle(const std::array<Vec3, 3>& p) {
    std::size_t first = 0;  // of the shortest side
    const auto side2 = [&](std::size_t i) { return norm2(p[(i + 1) % 3] - p[i]); };
    for (std::size_t i = 1; i < 3; ++i)
      if (side2(i) < side2(first)) first = i;
    middle = 0.5 * (p[first] + p[(first + 1) % 3]);
    axis = p[(first + 2) % 3] - middle;
    side = std::sqrt(side2(first));
    length = norm(axis);
    const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    const double size = norm(normal);
    up = size > 0 ? (1.0 / size) * normal : normal;
  }

  /// The place at the share t of the axis, so many times the height at which both angles are alike.
  Vec3 place(double t, double times_height = 1) const {
    return middle + t * axis + (times_height * std::sqrt(t * (1 - t) * side * length)) * up;
  }
};

}  // namespace hfr::detail

#endif
