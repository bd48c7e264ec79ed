// SPDX-License-Identifier: BSD-3-Clause
// Meshes that may be mended beside cells that nothing mends.
#ifndef HFR_UNITTESTS_REMESH_BESIDE_HH
#define HFR_UNITTESTS_REMESH_BESIDE_HH

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "HalfFace/Generate.hh"
#include "Operators/Clusters.hh"
#include "Quality/CellQuality.hh"

namespace hfr::test {

/// n cells round an edge, `beside` the axis of their rim: all alike, or nearly, and without an inner vertex.
inline TetMesh ring(Index n, double beside) {
  generate::Arrays arrays;
  arrays.points = {{beside, 0, 0}, {beside, 0, 1}};
  for (Index i = 0; i < n; ++i) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    arrays.points.push_back({std::cos(turn), std::sin(turn), 0.5});
    arrays.cells.push_back({0, 1, 2 + i, 2 + (i + 1) % n});
  }
  return built(arrays);
}

inline constexpr double kBeside = 100;  // x of what stands beside a mesh

/// The mesh with `points` and `cells` beside it, n times, each a step further.
inline TetMesh beside(const TetMesh& mesh, std::span<const Vec3> points, std::span<const Corners> cells,
                      Index n) {
  generate::Arrays all;
  all.points.assign(mesh.points().begin(), mesh.points().end());
  for (CellHandle c : mesh.cells()) {
    Corners corners{};
    for (std::size_t k = 0; k < 4; ++k) corners[k] = static_cast<Index>(mesh.cell(c).v[k].idx());
    all.cells.push_back(corners);
  }
  for (Index i = 0; i < n; ++i) {
    const auto first = static_cast<Index>(all.points.size());
    for (Vec3 p : points) all.points.push_back(p + Vec3{kBeside + 3.0 * i, 0, 0});
    for (Corners c : cells) {
      for (Index& corner : c) corner += first;
      all.cells.push_back(c);
    }
  }
  return built(all);
}

/// The mesh beside cells that touch nothing, and that their own faces hold at a degree.
inline TetMesh beside_slivers(const TetMesh& mesh, Index n) {
  const double half = 0.5 * std::numbers::pi / 180;
  const std::array<Vec3, 4> points = {
      {{-1, 0, 0}, {1, 0, 0}, {0, std::sin(half), std::cos(half)}, {0, -std::sin(half), std::cos(half)}}};
  return beside(mesh, points, std::array<Corners, 1>{{{0, 1, 2, 3}}}, n);
}

/// The mesh beside thin plates of six cells each, which are below 2 degrees: nothing is proven to hold them,
/// and nothing raises them.
inline TetMesh beside_plates(const TetMesh& mesh, Index n) {
  generate::Arrays plate = generate::box({1, 1, 1}, {0, 0, 0}, {1, 1, 0.02});
  return beside(mesh, plate.points, plate.cells, n);
}

/// Smallest dihedrals of what nothing was put beside, ascending.
inline std::vector<double> angles_without_beside(const TetMesh& mesh) {
  std::vector<double> angles;
  for (CellHandle c : mesh.cells())
    if (mesh.point(mesh.cell(c).v[0]).x < kBeside / 2)
      angles.push_back(quality(mesh, c, Metric::kMinDihedral));
  std::sort(angles.begin(), angles.end());
  return angles;
}

}  // namespace hfr::test

#endif
