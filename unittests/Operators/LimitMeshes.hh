// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_OPERATORS_LIMIT_MESHES_HH
#define HFR_UNITTESTS_OPERATORS_LIMIT_MESHES_HH

#include "Operators/Clusters.hh"

// Meshes with more of something than a fixed capacity holds.
namespace hfr::test {

/// An edge from vertex 0 (above) to vertex 1 (below) with n cells round it, in a shell of further cells: all
/// of the ring (vertices 4 … n+3) lies inside. Vertices 0 and 1 have 2n cells each; 2 and 3, above and below
/// on the boundary, have 3n cells and n boundary faces. 7n cells, all positive.
inline generate::Arrays hub(Index n) {
  generate::Arrays mesh;
  mesh.points = {{0, 0, 0.5}, {0, 0, -0.5}, {0, 0, 1.5}, {0, 0, -1.5}};
  for (const double radius : {1.0, 2.0}) {
    for (Index i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      mesh.points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    }
  }
  for (Index i = 0; i < n; ++i) {
    const Index p = 4 + i, q = 4 + (i + 1) % n;  // of the ring, and behind each its vertex of the shell
    mesh.cells.push_back({1, 0, p, q});
    mesh.cells.push_back({0, 2, p, q});
    mesh.cells.push_back({3, 1, p, q});
    mesh.cells.push_back({2, p, p + n, q});
    mesh.cells.push_back({2, q, p + n, q + n});
    mesh.cells.push_back({3, p, q, p + n});
    mesh.cells.push_back({3, q, q + n, p + n});
  }
  return mesh;
}

/// n points on a curve, every two of them joined by an edge: (n-2)(n-3)/2 cells {i, i+1, j, j+1}, the
/// Delaunay mesh of points on the moment curve. All cells are positive, all vertices on the boundary, and a
/// colouring needs n colours.
inline generate::Arrays neighbourly(Index n) {
  generate::Arrays mesh;
  for (Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n) - 0.5;
    mesh.points.push_back({t, t * t, t * t * t});
  }
  for (Index i = 0; i + 3 < n; ++i)
    for (Index j = i + 2; j + 1 < n; ++j) mesh.cells.push_back({i, j, i + 1, j + 1});
  return mesh;
}

/// Two jittered boxes of n³ cubes that touch in one vertex.
inline generate::Arrays pinched(Index n, double jitter, std::uint64_t seed) {
  generate::Arrays box = generate::jittered_box({n, n, n}, jitter, seed);
  const auto joint = static_cast<Index>(box.points.size()) - 1;  // (1, 1, 1)
  const generate::Arrays other = generate::jittered_box({n, n, n}, jitter, seed + 1, {1, 1, 1}, {2, 2, 2});
  for (auto cell : other.cells) {
    for (Index& v : cell) v = v == 0 ? joint : v + joint;
    box.cells.push_back(cell);
  }
  box.points.insert(box.points.end(), other.points.begin() + 1, other.points.end());
  return box;
}

/// Moves every vertex that is not on the boundary by up to `amount` in each direction.
inline void shake_inner(TetMesh& mesh, double amount, std::uint64_t seed) {
  for (VertexHandle v : mesh.vertices()) {
    if (mesh.is_boundary(v)) continue;
    Vec3 p = mesh.point(v);
    for (int d = 0; d < 3; ++d)
      p[d] += amount * (2 * generate::random_unit(seed, 3 * v.idx() + static_cast<Index>(d)) - 1);
    mesh.set_point(v, p);
  }
}

}  // namespace hfr::test

#endif
