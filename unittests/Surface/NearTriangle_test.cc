// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/NearTriangle.hh"

#include <gtest/gtest.h>

#include <random>

namespace hfr {
namespace {

using Engine = std::mt19937_64;

Vec3 random_point(Engine& engine, double low, double high) {
  std::uniform_real_distribution<double> u(low, high);
  const double x = u(engine), y = u(engine);
  return {x, y, u(engine)};
}

double distance(const std::array<Vec3, 3>& t, Vec3 x) { return norm(nearest_point(t, x) - x); }

TEST(NearTriangle, AnswersAsTheNearestPointDoes) {
  Engine engine(1);
  std::size_t n_near = 0;
  constexpr std::size_t kTries = 20'000;
  for (std::size_t i = 0; i < kTries; ++i) {
    std::array<Vec3, 3> t;
    for (Vec3& p : t) p = random_point(engine, 0, 1);
    // Thin, and so thin that no plane is of use.
    if (i % 3 == 0) t[2] = t[0] + 0.4 * (t[1] - t[0]) + (i % 2 == 0 ? 1e-4 : 1e-7) * t[2];
    const Vec3 x = random_point(engine, -0.2, 1.2);
    const NearTriangle near(t);
    const double exact = distance(t, x);
    for (double reach : {0.05, 0.3, 0.999 * exact, 1.001 * exact, (1 - 1e-8) * exact, (1 + 1e-8) * exact})
      EXPECT_EQ(near.is_within(x, reach), exact <= reach) << i << " " << reach << " " << exact;
    n_near += exact <= 0.3;
  }
  EXPECT_GT(n_near, kTries / 10) << "hardly a point is near";
  EXPECT_LT(n_near, kTries * 9 / 10) << "hardly a point is far";
}

TEST(NearTriangle, KnowsPointsOnItsPlaneInsideAndOutside) {
  const std::array<Vec3, 3> t = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  const NearTriangle near(t);
  EXPECT_TRUE(near.is_within({0.25, 0.25, 0}, 0));
  EXPECT_TRUE(near.is_within({0.25, 0.25, 0.1}, 0.1));
  EXPECT_TRUE(near.is_within({0.25, 0.25, -0.1}, 0.1));
  EXPECT_FALSE(near.is_within({0.25, 0.25, 0.1}, 0.09));
  EXPECT_FALSE(near.is_within({0.6, 0.6, 0}, 0.1));  // 0.14 beyond the long edge
  EXPECT_TRUE(near.is_within({0.6, 0.6, 0}, 0.15));
  EXPECT_FALSE(near.is_within({-0.1, -0.1, 0}, 0.12));  // 0.14 from the corner, 0.1 beyond either edge
}

TEST(NearTriangle, TakesTrianglesWithoutArea) {
  const std::array<Vec3, 3> segment = {{{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}};
  EXPECT_TRUE(NearTriangle(segment).is_within({1, 0.1, 0}, 0.11));
  EXPECT_FALSE(NearTriangle(segment).is_within({1, 0.1, 0}, 0.09));
  EXPECT_FALSE(NearTriangle(segment).is_within({2.2, 0, 0}, 0.19));
  const std::array<Vec3, 3> point = {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  EXPECT_TRUE(NearTriangle(point).is_within({1, 1, 1.5}, 0.6));
  EXPECT_FALSE(NearTriangle(point).is_within({1, 1, 1.5}, 0.4));
}

}  // namespace
}  // namespace hfr
