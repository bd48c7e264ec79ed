// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Ranks.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "HalfFace/Generate.hh"

namespace hfr::detail {
namespace {

void expect_as_sorted(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = values.size();
  const std::vector<std::size_t> ranks = {0, 0, n / 100, n / 20, n / 4, n / 2, n - 1, n - 1};
  for (const int threads : {1, 2, 5}) {
    const std::vector<double> found = values_at(values, ranks, {.threads = threads, .serial_below = 1});
    ASSERT_EQ(found.size(), ranks.size());
    for (std::size_t i = 0; i < ranks.size(); ++i)
      EXPECT_EQ(found[i], sorted[ranks[i]]) << ranks[i] << ", threads: " << threads;
  }
}

std::vector<double> random_values(std::size_t n, double scale) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(scale * (generate::random_unit(3, i) - 0.5));
  return values;
}

TEST(Ranks, AreThoseOfTheSortedOrder) {
  for (const std::size_t n : {1U, 2U, 3U, 100U, 10000U}) expect_as_sorted(random_values(n, 1));
}

TEST(Ranks, EqualValuesShareABin) {
  expect_as_sorted(std::vector<double>(1000, -0.25));
  std::vector<double> two(1000, 0.5);
  for (std::size_t i = 0; i < two.size(); i += 3) two[i] = 0.25;
  expect_as_sorted(two);
}

TEST(Ranks, AFewValuesFarOutLeaveTheOthersInOneBin) {
  std::vector<double> values = random_values(1000, 1);
  values[17] = -1e300;
  values[18] = 1e300;
  expect_as_sorted(values);
}

TEST(Ranks, RangesWithoutAQuotientAreSortedOut) {
  constexpr double kMost = std::numeric_limits<double>::max();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  expect_as_sorted({kMost, -kMost, 0, 1, -1});
  expect_as_sorted({kInfinity, -kInfinity, 0, 1, -1});
  expect_as_sorted({0, std::numeric_limits<double>::denorm_min(), 0});
}

}  // namespace
}  // namespace hfr::detail
