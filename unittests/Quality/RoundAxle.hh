// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_QUALITY_ROUND_AXLE_HH
#define HFR_UNITTESTS_QUALITY_ROUND_AXLE_HH

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr::test {

/// Where the vertices of round_axle() are: the centre, the two ends of the axle, and n of the rim from 0 to
/// so many degrees, or one less where the last would be the first.
inline std::vector<Vec3> points_round_axle(int n, double degrees, bool closed) {
  std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int i = 0; i < (closed ? n : n + 1); ++i) {
    const double angle = degrees * i / n * std::numbers::pi / 180;
    points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  return points;
}

/// Cells of vertex 0 round its edges to 1 and 2, which lie opposite one another: n of each, side by side, the
/// last ones beside the first where `closed`. No face of vertex 0 lies on another one, however many turns the
/// cells make.
inline TetMesh round_axle(int n, const std::vector<Vec3>& points) {
  std::vector<std::array<Index, 4>> cells;
  const auto n_rim = static_cast<Index>(points.size() - 3);
  for (Index i = 0; i < static_cast<Index>(n); ++i) {
    const Index here = 3 + i, next = 3 + (i + 1) % n_rim;
    cells.push_back({0, 1, here, next});
    cells.push_back({0, 2, next, here});
  }
  return build(points, cells);
}

inline TetMesh round_axle(int n, double degrees, bool closed) {
  return round_axle(n, points_round_axle(n, degrees, closed));
}

}  // namespace hfr::test

#endif
