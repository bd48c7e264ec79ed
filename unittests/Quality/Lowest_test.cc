// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Lowest.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace hfr::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Lowest, IsTheFirstOfEqualsAndPassesOverNaN) {
  std::mt19937_64 engine(3);
  int ties = 0;
  int all_passed_over = 0;
  for (int round = 0; round < 5000; ++round) {
    const std::size_t n = kLowestBlock * (engine() % 8);
    std::vector<double> numbers(n);
    for (double& x : numbers) {
      const auto kind = engine() % (round % 10 == 0 ? 2 : 8);
      x = kind == 0   ? kInfinity
          : kind == 1 ? std::numeric_limits<double>::quiet_NaN()
          : kind == 2 ? (engine() % 2 == 0 ? 0.0 : -0.0)
                      : static_cast<double>(engine() % 40) - (round % 3 == 0 ? 5 : 0);
      if (engine() % 500 == 0) x = -kInfinity;
    }
    std::size_t at = 0;
    double least = kInfinity;
    for (std::size_t i = 0; i < n; ++i) {
      ties += numbers[i] == least ? 1 : 0;
      if (!(numbers[i] < least)) continue;
      least = numbers[i];
      at = i;
    }
    all_passed_over += n > 0 && least == kInfinity ? 1 : 0;
    const Lowest found = lowest_of(numbers.data(), n);
    EXPECT_EQ(found.at, at);
    EXPECT_EQ(found.value, least);
  }
  EXPECT_GT(ties, 1000);
  EXPECT_GT(all_passed_over, 100);
}

TEST(Lowest, FloorIsTheSmallestAndHoldsWhereNoneIsBelow) {
  std::mt19937_64 engine(4);
  int n_held = 0, n_broken = 0, n_by_nan = 0;
  for (int round = 0; round < 5000; ++round) {
    std::vector<double> numbers(kLowestBlock * (engine() % 6));
    const bool with_nan = round % 7 == 0;
    for (double& x : numbers) {
      x = static_cast<double>(engine() % 40) - (round % 3 == 0 ? 1 : 0);
      if (engine() % 9 == 0) x = engine() % 2 == 0 ? kInfinity : -0.0;
      if (with_nan && engine() % 30 == 0) x = std::numeric_limits<double>::quiet_NaN();
    }
    double least = kInfinity;
    bool holds = true, is_below = false;
    for (const double x : numbers) {
      if (x < least) least = x;
      holds = holds && x >= 0;
      is_below = is_below || x < 0;
    }
    const Floor floor = floor_of(numbers.data(), numbers.size(), 0);
    EXPECT_EQ(floor.least, least);
    EXPECT_FALSE(std::signbit(floor.least) && floor.least == 0);
    EXPECT_EQ(floor.holds, holds);
    ++(holds ? n_held : n_broken);
    n_by_nan += !holds && !is_below ? 1 : 0;
  }
  EXPECT_GT(n_held, 1000);
  EXPECT_GT(n_broken, 500);
  EXPECT_GT(n_by_nan, 50);
}

}  // namespace
}  // namespace hfr::test
