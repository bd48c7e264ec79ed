// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Surface.
#ifndef HFR_SURFACE_PLANE_STAR_HH
#define HFR_SURFACE_PLANE_STAR_HH

#include <cmath>
#include <span>

namespace hfr::surface {

struct Point2 {
  double x = 0, y = 0;

  friend Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
  friend Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
  friend Point2 operator*(double s, Point2 a) { return {s * a.x, s * a.y}; }
  friend bool operator==(Point2, Point2) = default;
};
inline double dot(Point2 a, Point2 b) { return a.x * b.x + a.y * b.y; }
inline double cross(Point2 a, Point2 b) { return a.x * b.y - a.y * b.x; }

/// A triangle as its vertex at x sees it: the other two, in turn.
struct Side {
  Point2 a, b;

  double sum2(Point2 x) const { return dot(b - a, b - a) + dot(x - a, x - a) + dot(x - b, x - b); }
  double twice_area(Point2 x) const { return cross(b - a, x - a); }
};
/// Twice the area of a regular triangle with this sum of squared edges.
inline double regular_area(double sum2) { return sum2 / (2.0 * std::sqrt(3.0)); }

/// Where a vertex at x makes the energy of its triangles less, each by its other two corners. What unfold()
/// of Operators/Unfold.hh does in space.
Point2 unfold_in_plane(std::span<const Side> sides, Point2 x);

}  // namespace hfr::surface

#endif
