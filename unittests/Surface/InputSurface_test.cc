// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/InputSurface.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "Operators/Clusters.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

std::vector<std::array<Vec3, 3>> random_triangles(std::size_t n, Engine& engine) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 at = random_point(engine, -1, 1);
    triangles.push_back({at, at + random_point(engine, -0.2, 0.2), at + random_point(engine, -0.2, 0.2)});
  }
  return triangles;
}

TEST(NearestPoint, IsNoFurtherThanAnyPointOfTheTriangle) {
  Engine engine(1);
  for (int i = 0; i < 300; ++i) {
    const auto t = random_triangles(1, engine)[0];
    const Vec3 x = t[0] + random_point(engine, -0.4, 0.4);
    const double distance = norm(nearest_point(t, x) - x);
    double least = std::numeric_limits<double>::infinity();
    constexpr int kCuts = 40;
    for (int u = 0; u <= kCuts; ++u)
      for (int v = 0; u + v <= kCuts; ++v)
        least = std::min(
            least, norm(t[0] + (1.0 * u / kCuts) * (t[1] - t[0]) + (1.0 * v / kCuts) * (t[2] - t[0]) - x));
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GE(distance, least - 0.02);  // a step of the grid
  }
}

TEST(NearestPoint, OfALevelTriangleIsLevelToTheLastBit) {
  const double z = 0.1 + 0.2;
  const std::array<Vec3, 3> t = {{{0.1, 0.3, z}, {1.7, 0.2, z}, {0.4, 2.9, z}}};
  Engine engine(2);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(nearest_point(t, random_point(engine, -1, 3)).z, z);
}

TEST(NearestPoint, OfAPointOnANeedleIsThatPoint) {
  Engine engine(3);
  for (int i = 0; i < 3000; ++i) {
    auto t = random_triangles(1, engine)[0];
    const double height = std::pow(10.0, -1 - i % 16);
    t[2] = t[0] + 0.3 * (t[1] - t[0]) + height * (t[2] - t[0]);
    std::rotate(t.begin(), t.begin() + i % 3, t.end());
    for (int k = 0; k < 10; ++k) {
      double u = k < 3 ? k == 1 : std::abs(random_point(engine, -1, 1).x);
      double v = k < 3 ? k == 2 : std::abs(random_point(engine, -1, 1).y);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3 x = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
      EXPECT_LT(norm(exact_nearest_point(t, x) - x), 2e-14) << "of height " << height;
    }
  }
}

TEST(SurfaceDistance, OfASurfaceOfNeedlesFromItselfIsRounding) {
  Engine engine(4);
  std::vector<std::array<Vec3, 3>> needles = random_triangles(200, engine);
  for (auto& t : needles)
    for (Vec3& p : t) p.z *= 1e-8;
  for (auto& t : needles) t[2] = t[0] + 0.3 * (t[1] - t[0]) + 1e-8 * (t[2] - t[0]);
  EXPECT_LT(surface_distance(needles, needles, 0.02).hausdorff(), 1e-15);
}

TEST(InputSurface, FindsWhatASearchOfAllTrianglesFinds) {
  Engine engine(3);
  const auto triangles = random_triangles(200, engine);
  const InputSurface surface(triangles);
  EXPECT_EQ(surface.size(), triangles.size());
  std::size_t n_within = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 x = random_point(engine, -1.5, 1.5);
    const Vec3 side = random_point(engine, -1, 1);
    double least = std::numeric_limits<double>::infinity();
    double least_of_side = least;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const double distance = norm(nearest_point(triangles[k], x) - x);
      least = std::min(least, distance);
      if (dot(surface.normal(k), side) >= 0) least_of_side = std::min(least_of_side, distance);
    }
    EXPECT_DOUBLE_EQ(surface.nearest(x).distance, least);
    constexpr double kLimit = 0.3;
    const InputSurface::Hit hit = surface.nearest_within(x, kLimit);
    n_within += least <= kLimit;
    EXPECT_EQ(hit.distance <= kLimit, least <= kLimit);
    if (least <= kLimit) {
      EXPECT_DOUBLE_EQ(hit.distance, least);
    }
    EXPECT_DOUBLE_EQ(surface.nearest_within(x, 10, side).distance, least_of_side);
  }
  EXPECT_GT(n_within, 20U) << "the limit is never met";
  EXPECT_LT(n_within, 180U) << "the limit is always met";
}

TEST(InputSurface, GuessesChangeNoAnswer) {
  Engine engine(4);
  const auto triangles = random_triangles(200, engine);
  const InputSurface surface(triangles);
  std::size_t n_within = 0;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Vec3 x = random_point(engine, -1.5, 1.5);
    const Vec3 side = random_point(engine, -1, 1);
    const std::vector<std::uint32_t> guesses = {i, (i * 7) % 200};
    const double least = surface.nearest(x).distance;
    EXPECT_EQ(surface.nearest(x, i).distance, least);
    EXPECT_EQ(surface.nearest_within(x, 0.5, side, guesses).distance,
              surface.nearest_within(x, 0.5, side).distance);
    constexpr double kLimit = 0.3;
    n_within += least <= kLimit;
    const double distance = surface.distance(x, i);
    EXPECT_EQ(distance, norm(nearest_point(triangles[i], x) - x));
    EXPECT_EQ(surface.is_within(x, kLimit, i), distance <= kLimit);
    EXPECT_TRUE(surface.is_within(x, 1.001 * distance, i));
    const auto found = surface.any_within(x, kLimit);
    EXPECT_EQ(found.has_value(), least <= kLimit);
    EXPECT_LE(surface.distance(x, found.value_or(surface.nearest(x).item)), std::max(kLimit, least));
  }
  EXPECT_GT(n_within, 20U) << "the limit is never met";
  EXPECT_LT(n_within, 180U) << "the limit is always met";
}

TEST(InputSurface, OfOneTriangleOrOneSegmentAnswersToo) {
  const std::vector<std::array<Vec3, 3>> triangle = {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
  EXPECT_DOUBLE_EQ(InputSurface(triangle).nearest({0.2, 0.2, 3}).distance, 3);
  const std::vector<std::array<Vec3, 2>> segment = {{{{0, 0, 0}, {1, 0, 0}}}};
  EXPECT_EQ(InputSurface(segment).nearest({0.25, 1, 0}).point, (Vec3{0.25, 0, 0}));
}

}  // namespace
}  // namespace hfr::test
