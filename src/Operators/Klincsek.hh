// SPDX-License-Identifier: BSD-3-Clause
// G. T. Klincsek, Minimal triangulations of polygonal domains, 1980.
#ifndef HFR_OPERATORS_KLINCSEK_HH
#define HFR_OPERATORS_KLINCSEK_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "Operators/Cavity.hh"
#include "kernels/klincsek.h"

namespace hfr {

/// Klincsek's table over the sides (i, j) of the ring polygon.
class RingTriangulation {
 public:
  explicit RingTriangulation(int n) : n_(n) {}

  /// Largest worst value over all triangulations, `floor` where none is better than it. value(i, k, j, floor)
  /// is the worst of the two cells of triangle (i, k, j), or anything ≤ floor once it is no better.
  template <class Value>
  double solve(double floor, Value&& value) {
    double result = floor;
    if (n_ < 2) return result;  // no side; g++ fears that best_[0] is read then
    HFR_KLINCSEK(n_, HFR_MAX_RING, best_.data(), apex_.data(), floor, value, result);
    return result;
  }

  /// After solve(): the largest worst value over the polygon i … j, minus infinity where none beats the
  /// floor.
  double best(int i, int j) const { return best_[static_cast<std::size_t>(i * HFR_MAX_RING + j)]; }

  /// Writes the apexes in preorder.
  void preorder(std::uint8_t* out) const { preorder(0, n_ - 1, out); }
  /// The same for the polygon i … j. Returns where the next would stand.
  std::uint8_t* preorder(int i, int j, std::uint8_t* out) const {
    if (j - i < 2) return out;
    const std::uint8_t k = apex_[static_cast<std::size_t>(i * HFR_MAX_RING + j)];
    *out++ = k;
    return preorder(k, j, preorder(i, k, out));
  }

 private:
  int n_;
  std::array<double, HFR_MAX_RING * HFR_MAX_RING> best_;
  std::array<std::uint8_t, HFR_MAX_RING * HFR_MAX_RING> apex_;
};

/// visit(i, k, j) for each triangle of a triangulation stored in preorder.
template <class Visit>
const std::uint8_t* for_triangles(int i, int j, const std::uint8_t* apex, Visit&& visit) {
  if (j - i < 2) return apex;
  const int k = *apex++;
  visit(i, k, j);
  apex = for_triangles(i, k, apex, visit);
  return for_triangles(k, j, apex, visit);
}

/// What solve() asks for where triangle (i, k, j) of the ring makes a cell with a and one with b. The points
/// of the ring are counter-clockwise about a→b, so that a triangle is positive with b, and reversed with a.
/// Keeps references to the metric and the points.
template <class Metric>
auto ring_value(const Metric& metric, std::span<const Vec3> points, Vec3 a, Vec3 b) {
  return [&metric, points, a, b](int i, int k, int j, double floor) {
    const Vec3 x = points[static_cast<std::size_t>(i)];
    const Vec3 y = points[static_cast<std::size_t>(k)];
    const Vec3 z = points[static_cast<std::size_t>(j)];
    const double upper = metric(x, y, z, b);
    return upper > floor ? std::min(upper, metric(y, x, z, a)) : upper;
  };
}

/// Appends these two cells of each triangle to the created ones. `apex`: the triangulation of the polygon
/// 0 … last in preorder.
inline void append_ring_cells(std::span<const VertexHandle> ring, VertexHandle a, VertexHandle b, int last,
                              const std::uint8_t* apex, Cavity& out) {
  for_triangles(0, last, apex, [&](int i, int k, int j) {
    const VertexHandle x = ring[static_cast<std::size_t>(i)];
    const VertexHandle y = ring[static_cast<std::size_t>(k)];
    const VertexHandle z = ring[static_cast<std::size_t>(j)];
    out.created.push_back({x, y, z, b});
    out.created.push_back({y, x, z, a});
  });
}

}  // namespace hfr

#endif
