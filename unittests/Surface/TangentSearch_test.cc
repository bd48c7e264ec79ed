// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/TangentSearch.hh"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "HalfFace/Generate.hh"

namespace hfr::surface {
namespace {

Vec3 random_vector(std::uint64_t seed, std::size_t i) {
  const auto at = [&](std::size_t k) { return 2 * generate::random_unit(seed, 3 * i + k) - 1; };
  return {at(0), at(1), at(2)};
}
Vec3 of_length_one(Vec3 n) { return (1 / norm(n)) * n; }

TEST(NormalTo, IsNormalToAnyDirection) {
  for (std::size_t i = 0; i < 1000; ++i) {
    const Vec3 n = random_vector(1, i);
    const Vec3 u = normal_to(n);
    EXPECT_GT(norm(u), 0.5 * norm(n));
    EXPECT_EQ(dot(n, u), 0.0) << "two products of the same numbers";
  }
}

TEST(NormalTo, LeavesTheCoordinateOfAnAxisAlone) {
  for (double length : {1.0, -2.5}) {
    EXPECT_EQ(normal_to({length, 0, 0}).x, 0.0);
    EXPECT_EQ(normal_to({0, length, 0}).y, 0.0);
    EXPECT_EQ(normal_to({0, 0, length}).z, 0.0);
  }
}

TEST(TangentSteps, GoBothWaysAlongALine) {
  const Vec3 axis = of_length_one({1, 2, -2});
  const auto places = TangentSteps::on_line(axis).at(0.5, {3, 4, 5});
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0], (Vec3{3, 4, 5} + 0.5 * axis));
  EXPECT_EQ(places[1], (Vec3{3, 4, 5} - 0.5 * axis));
}

TEST(TangentSteps, GoEightWaysInAPlaneNoTwoOfThemAlike) {
  for (std::size_t i = 0; i < 50; ++i) {
    const Vec3 axis = of_length_one(random_vector(2, i));
    const Vec3 centre = random_vector(3, i);
    const auto places = TangentSteps::in_plane(axis, of_length_one(normal_to(axis))).at(0.25, centre);
    ASSERT_EQ(places.size(), 8U);
    Vec3 sum;
    std::size_t n_near = 0, n_far = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Vec3 step = places[k] - centre;
      EXPECT_NEAR(dot(step, axis), 0.0, 1e-15);
      n_near += std::abs(norm(step) - 0.25) < 1e-12 ? 1 : 0;
      const double diagonal = 0.25 * std::sqrt(2.0);
      n_far += std::abs(norm(step) - diagonal) < 1e-12 ? 1 : 0;
      sum = sum + step;
      for (std::size_t j = 0; j < k; ++j) EXPECT_GT(norm(places[j] - places[k]), 0.2);
    }
    EXPECT_EQ(n_near, 4U);
    EXPECT_EQ(n_far, 4U);
    EXPECT_NEAR(norm(sum), 0.0, 1e-14);
  }
}

TEST(SearchByHalving, HalvesAsOftenAsTheLookSays) {
  std::vector<double> radii;
  const std::vector<int> said = {0, 1, 0, 0, 2, 1};
  search_by_halving(8.0, 4, [&](double radius) {
    radii.push_back(radius);
    return said[radii.size() - 1];
  });
  EXPECT_EQ(radii, (std::vector<double>{8, 8, 4, 4, 4, 1}));
  search_by_halving(1.0, 0, [](double) -> int { throw "no look is due"; });
}

TEST(SearchByHalving, EndsWhereHalvingTwiceGoesBeyondTheLast) {
  int n_looks = 0;
  search_by_halving(1.0, 3, [&](double) {
    ++n_looks;
    return 2;
  });
  EXPECT_EQ(n_looks, 2);
}

TEST(SearchByHalving, EndsWhereEveryStepIsBetterThanTheLast) {
  int looks = 0;
  const auto further = [&](double) {
    if (++looks > 1'000'000) throw std::runtime_error("for ever");
    return 0;
  };
  search_by_halving(1.0, 3, further);
  EXPECT_EQ(looks, kMostSteps + 2);
}

TEST(SearchPlacesByHalving, ComesWithinTheLastRadiusOfTheHighestPlace) {
  constexpr int kHalvings = 10;
  for (std::size_t i = 0; i < 100; ++i) {
    const Vec3 summit = {random_vector(4, i).x, random_vector(4, i).y, 0};
    Vec3 place;
    double best = -norm2(place - summit);
    const TangentSteps steps = TangentSteps::in_plane({0, 0, 1}, of_length_one(normal_to({0, 0, 1})));
    const auto consider = [&](Vec3 x) {
      if (!(-norm2(x - summit) > best)) return false;
      best = -norm2(x - summit);
      place = x;
      return true;
    };
    search_places_by_halving(
        0.5, kHalvings, [&](double r) { return steps.at(r, place); }, consider);
    EXPECT_LT(norm(place - summit), std::ldexp(1.0, -kHalvings));
    EXPECT_EQ(place.z, 0.0);
  }
}

TEST(SearchPlacesByHalving, TriesAllPlacesRoundTheOneThatALookBeginsWith) {
  double place = 0;
  std::vector<Vec3> tried;
  const auto places_at = [&](double r) {
    return std::array<Vec3, 2>{Vec3{place + r, 0, 0}, Vec3{place - r, 0, 0}};
  };
  search_places_by_halving(1.0, 1, places_at, [&](Vec3 x) {
    tried.push_back(x);
    if (tried.size() > 1) return false;
    place = x.x;
    return true;
  });
  EXPECT_EQ(tried, (std::vector<Vec3>{{1, 0, 0}, {-1, 0, 0}, {2, 0, 0}, {0, 0, 0}}));
}

}  // namespace
}  // namespace hfr::surface
