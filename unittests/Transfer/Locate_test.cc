// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Locate.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "HalfFace/Generate.hh"
#include "Quality/Tets.hh"
#include "Transfer/Stars.hh"

namespace hfr::test {
namespace {

Place located(const TetMesh& mesh, Vec3 point, VertexHandle near) {
  return locate(mesh, point, Stars(mesh, std::array{near}, {}).of(near));
}

TetMesh box(double jitter = 0.2) {
  const generate::Arrays arrays = generate::jittered_box({6, 6, 6}, jitter, 5);
  return build(arrays.points, arrays.cells);
}

Vec3 point_of(const TetMesh& mesh, const Place& place) {
  Vec3 sum;
  const auto& v = mesh.cell_vertices(place.cell);
  for (std::size_t k = 0; k < 4; ++k) sum = sum + place.weights[k] * mesh.point(v[k]);
  return sum;
}

void expect_same(Vec3 a, Vec3 b) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-12);
}

TEST(Locate, PointsAnywhereAreFoundFromAnyVertex) {
  const TetMesh mesh = box();
  RandomTets random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random.point();
    const Place at = located(mesh, p, VertexHandle(static_cast<std::size_t>(i) * 7 % mesh.n_vertices()));
    ASSERT_TRUE(at.inside);
    expect_same(point_of(mesh, at), p);
    EXPECT_GE(*std::min_element(at.weights.begin(), at.weights.end()), -1e-10);
  }
}

TEST(Locate, PointsAtVerticesAndOnTheSurfaceAreInside) {
  const TetMesh mesh = box();
  for (VertexHandle v : mesh.vertices()) {
    const Place at = located(mesh, mesh.point(v), v);
    ASSERT_TRUE(at.inside);
    expect_same(point_of(mesh, at), mesh.point(v));
  }
}

TEST(Locate, PointBeyondTheSurfaceIsSaidToBeOutsideWithTheCellThatItIsLeastOutsideOf) {
  const TetMesh mesh = box(0);
  const Place at = located(mesh, {0.52, 0.51, 1.03}, VertexHandle(0));
  ASSERT_TRUE(at.cell.is_valid());
  EXPECT_FALSE(at.inside);
  expect_same(point_of(mesh, at), {0.52, 0.51, 1.03});
}

TEST(Locate, PointsAnyNumberOfCellsAwayAreFound) {
  const generate::Arrays arrays = generate::jittered_box({3000, 1, 1}, 0.1, 5);
  const TetMesh mesh = build(arrays.points, arrays.cells);
  const auto at_x = [&](double x) {
    std::size_t nearest = 0;
    for (VertexHandle v : mesh.vertices())
      if (std::abs(mesh.point(v).x - x) < std::abs(mesh.point(VertexHandle(nearest)).x - x))
        nearest = v.idx();
    return VertexHandle(nearest);
  };
  const double length = mesh.point(at_x(1e9)).x;
  for (const double share : {0.05, 0.08, 0.1, 0.9, 1.0}) {  // of 15,000 cells
    const Vec3 p = {share * length, 0.41, 0.52};
    const Place at = located(mesh, p, at_x(0));
    ASSERT_TRUE(at.inside) << share;
    expect_same(point_of(mesh, at), p);
  }
}

TEST(Locate, InvertedCellsOnTheWayDoNotHideThePoint) {
  const generate::Arrays arrays = generate::cavity();
  const TetMesh mesh = build(arrays.points, arrays.cells);
  RandomTets random(4);
  int n_found = 0;
  for (int i = 0; i < 300; ++i) {
    const VertexHandle near(static_cast<std::size_t>(i) * 11 % mesh.n_vertices());
    const Vec3 p = mesh.point(near) + 0.05 * (random.point() - Vec3{0.5, 0.5, 0.5});
    if (std::min({p.x, p.y, p.z}) < 0 || std::max({p.x, p.y, p.z}) > 1) continue;
    ++n_found;
    const Place at = located(mesh, p, near);
    ASSERT_TRUE(at.inside);
    expect_same(point_of(mesh, at), p);
  }
  EXPECT_GT(n_found, 200);
}

TEST(Locate, AroundFlatCellsOnlyThereIsNoPlace) {
  const TetMesh mesh =
      build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, std::vector<std::array<Index, 4>>{{0, 1, 2, 3}});
  EXPECT_FALSE(located(mesh, {0.3, 0.3, 0}, VertexHandle(0)).cell.is_valid());
}

}  // namespace
}  // namespace hfr::test
