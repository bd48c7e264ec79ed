// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/FoldedFaces.hh"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "HalfFace/Generate.hh"

namespace hfr::test {
namespace {

using Corners = std::array<Index, 4>;

TetMesh box(Index n, double jitter, std::uint64_t seed = 1) {
  const generate::Arrays arrays = generate::jittered_box({n, n, n}, jitter, seed);
  return build(arrays.points, arrays.cells);
}

/// By brute force over the flat sides of a box: triangles whose signed area in the plane of their side has
/// the sign that fewer of that side's have.
std::size_t n_turned_on_box(const TetMesh& mesh) {
  std::size_t turned = 0;
  for (int d = 0; d < 3; ++d) {
    for (const double side : {0.0, 1.0}) {
      std::array<std::size_t, 2> n{};
      for (CellHandle c : mesh.cells()) {
        for (int k = 0; k < 4; ++k) {
          if (mesh.opposite_halfface(halfface_of(c, k)).is_valid()) continue;
          const auto f = mesh.halfface_vertices(halfface_of(c, k));
          const Vec3 a = mesh.point(f[0]), b = mesh.point(f[1]), e = mesh.point(f[2]);
          if (a[d] != side || b[d] != side || e[d] != side) continue;
          ++n[cross(b - a, e - a)[d] > 0 ? 1 : 0];
        }
      }
      turned += std::min(n[0], n[1]);
    }
  }
  return turned;
}

TEST(FoldedFaces, SolidsHaveNone) {
  EXPECT_TRUE(folded_faces(box(4, 0.25)).empty());
  const auto ball = generate::ball(4);
  EXPECT_TRUE(folded_faces(build(ball.points, ball.cells)).empty());
  const auto cylinder = generate::cylinder(3, 6, 1, 2, 40);
  EXPECT_TRUE(folded_faces(build(cylinder.points, cylinder.cells)).empty());
}

TEST(FoldedFaces, TurnedTrianglesOfAFlatSideAreFound) {
  int with_folds = 0;
  for (std::uint64_t s = 1; s <= 20; ++s) {
    const TetMesh mesh = box(5, 0.5, s);
    const std::size_t turned = n_turned_on_box(mesh);
    const auto folded = folded_faces(mesh);
    EXPECT_EQ(folded.empty(), turned == 0) << s;
    EXPECT_GE(folded.size(), turned);
    with_folds += turned > 0 ? 1 : 0;
    for (VertexHandle v : mesh.vertices()) {
      const std::array<VertexHandle, 1> one = {v};
      const auto at_v = [&](VertexHandle u) { return u == v; };
      ASSERT_EQ(is_folded_at(mesh, one), !folded_faces(mesh, {}, at_v).empty()) << "vertex " << v.idx();
    }
    for (HalfFaceHandle h : folded) EXPECT_TRUE(mesh.is_boundary(h));
  }
  EXPECT_GT(with_folds, 10);
}

TEST(FoldedFaces, FaceThroughAnotherAtACommonVertexIsFound) {
  // Two cells that share vertex 0 only; an edge of the second goes through a face of the first.
  const std::vector<Vec3> points = {{0, 0, 0},  {1, 0, 0}, {0, 1, 0},      {0.4, 0.4, 1},
                                    {1, 1, -1}, {1, 1, 2}, {1.5, 0.2, 0.1}};
  const std::vector<Corners> cells = {{0, 1, 2, 3}, {0, 4, 5, 6}};
  EXPECT_FALSE(folded_faces(build(points, cells)).empty());
  std::vector<Vec3> apart = points;
  for (std::size_t i = 4; i < 7; ++i) apart[i] = -1.0 * points[i];
  EXPECT_TRUE(folded_faces(build(apart, cells)).empty());
}

/// A fan of cells round an axle, whose ends have as many boundary faces; rim vertices `swapped` and the next
/// have changed places where it is not 0.
TetMesh fan(Index n, Index swapped) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<Corners> cells;
  for (Index i = 0; i <= n; ++i) {
    const Index at = swapped > 0 && i == swapped ? i + 1 : swapped > 0 && i == swapped + 1 ? i - 1 : i;
    const double angle = 6 * static_cast<double>(at) / static_cast<double>(n);
    points.push_back({std::cos(angle), std::sin(angle), 0});
    if (i > 0) cells.push_back({0, 1, i + 1, i + 2});
  }
  return build(points, cells);
}

/// With few faces at a vertex each is held against each other one, with many those in the same directions.
TEST(FoldedFaces, AtAVertexOfManyFacesAreThoseOfAFew) {
  for (const Index n : {40, 400}) {
    EXPECT_TRUE(folded_faces(fan(n, 0)).empty()) << n;
    for (const Index swapped : {n / 5, n / 2, n - 3}) {
      const TetMesh mesh = fan(n, swapped);
      // At each end of the axle the faces before and behind those two go through each other.
      EXPECT_EQ(folded_faces(mesh).size(), 4U) << n << " " << swapped;
      if (n < 256) {
        EXPECT_TRUE(is_folded_at(mesh, std::array{VertexHandle(0)}));
      }
    }
  }
}

TEST(FoldedFaces, TangledInsideWithASoundBoundaryHasNone) {
  generate::CavityOptions options;
  options.counts = {8, 8, 8};
  options.amplitude = 0.5;
  const auto arrays = generate::cavity(options);
  EXPECT_TRUE(folded_faces(build(arrays.points, arrays.cells)).empty());
}

}  // namespace
}  // namespace hfr::test
