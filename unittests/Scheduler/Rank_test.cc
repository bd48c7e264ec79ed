// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/Rank.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

TEST(QualityBucket, WhatIsNotPositiveComesFirst) {
  EXPECT_EQ(quality_bucket(0.0), 0U);
  EXPECT_EQ(quality_bucket(-0.5), 0U);
  EXPECT_EQ(quality_bucket(-std::numeric_limits<double>::infinity()), 0U);
  EXPECT_EQ(quality_bucket(std::numeric_limits<double>::quiet_NaN()), 0U);
  EXPECT_EQ(quality_bucket(std::numeric_limits<double>::denorm_min()), 1U);
}

TEST(QualityBucket, IsMonotoneWithOneLevelAPowerOfTwo) {
  EXPECT_EQ(quality_bucket(1.0), 15U);
  EXPECT_EQ(quality_bucket(1e10), 15U);
  EXPECT_EQ(quality_bucket(0.75), 14U);
  EXPECT_EQ(quality_bucket(0.5), 14U);
  EXPECT_EQ(quality_bucket(0.25), 13U);
  std::uint64_t last = 0;
  std::set<std::uint64_t> seen;
  for (double q = 1e-20; q < 2; q *= 1.01) {
    EXPECT_GE(quality_bucket(q), last);
    last = quality_bucket(q);
    seen.insert(last);
  }
  EXPECT_EQ(seen.size(), 15U);
}

TEST(Priority, BucketOutranksTheHashAndTheSaltReordersEquals) {
  Engine engine(1);
  int swapped = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Tet a = {V(engine() % 1000), VertexHandle(), VertexHandle(), VertexHandle()};
    const Tet b = {V(1000 + engine() % 1000), VertexHandle(), VertexHandle(), VertexHandle()};
    EXPECT_LT(priority(0.1, a, 1), priority(0.9, b, 1));
    EXPECT_LT(priority(-0.1, a, 1), priority(1e-12, b, 1));
    EXPECT_EQ(priority(0.3, a, 7), priority(0.3, a, 7));
    swapped += (priority(0.3, a, 1) < priority(0.3, b, 1)) != (priority(0.3, a, 2) < priority(0.3, b, 2));
  }
  EXPECT_GT(swapped, 50);
  EXPECT_LT(swapped, 150);
}

TEST(PriorityByGain, BucketOutranksTheGainAndTheGainOutranksTheHash) {
  Engine engine(4);
  int swapped = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Tet a = {V(engine() % 1000), VertexHandle(), VertexHandle(), VertexHandle()};
    const Tet b = {V(1000 + engine() % 1000), VertexHandle(), VertexHandle(), VertexHandle()};
    EXPECT_LT(priority_by_gain(0.1, 0.11, a, 1), priority_by_gain(0.9, 1.0, b, 1));
    EXPECT_LT(priority_by_gain(0.3, 0.8, a, 1), priority_by_gain(0.3, 0.7, b, 1));
    EXPECT_LT(priority_by_gain(-0.3, 1e-3, a, 1), priority_by_gain(-0.3, -0.1, b, 1));
    EXPECT_LT(priority_by_gain(-0.3, 1e-4, a, 1), priority_by_gain(-0.3, 1e-9, b, 1));
    const auto first = [&](std::uint64_t salt) {
      return priority_by_gain(0.3, 0.8, a, salt) < priority_by_gain(0.3, 0.8, b, salt);
    };
    swapped += first(1) != first(2) ? 1 : 0;
  }
  EXPECT_GT(swapped, 50);
  EXPECT_LT(swapped, 150);
}

TEST(WorstFirst, IsInTheOrderOfTheDecisionValues) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<double> ascending = {-inf, -2, -1, -1e-300, 0, 1e-300, 0.1, 0.1000001, 1, inf};
  for (std::size_t i = 1; i < ascending.size(); ++i)
    EXPECT_LT(worst_first(ascending[i - 1]), worst_first(ascending[i])) << ascending[i];
  EXPECT_EQ(worst_first(-0.0), worst_first(0.0));
}

// The number is what builds of 32 bits give: with 64 the output would be another mesh if it differed.
TEST(Priority, IsTheSameForIndicesOfEitherWidth) {
  EXPECT_EQ(priority(1.0, Tet{VertexHandle(3), VertexHandle(7)}, 5), 0xf28187b1faaddba3U);
}

TEST(Rank, EqualRanksAreOrderedByVertices) {
  for (const std::size_t n : {10, 2000}) {  // either sort
    Engine engine(2);
    std::vector<Tet> identities;
    std::vector<par::KeyIndex> keys;
    for (std::size_t i = 0; i < n; ++i) {
      identities.push_back({V(engine() % 1000000), V(i), V(0), V(0)});
      keys.push_back({engine() % 5, static_cast<std::uint32_t>(i)});
    }
    std::vector<par::KeyIndex> expected = keys;
    std::sort(expected.begin(), expected.end(), [&](const auto& x, const auto& y) {
      return std::pair(x.key, identities[x.index]) < std::pair(y.key, identities[y.index]);
    });
    for (const int threads : {1, 2, 3, 7}) {
      std::shuffle(keys.begin(), keys.end(), engine);
      std::vector<par::KeyIndex> sorted_keys = keys;
      std::vector<par::KeyIndex> scratch;
      rank({threads, 1}, sorted_keys, scratch, identities);
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_EQ(sorted_keys[i].key, expected[i].key);
        EXPECT_EQ(sorted_keys[i].index, expected[i].index);
      }
    }
  }
}

}  // namespace
}  // namespace hfr::test
