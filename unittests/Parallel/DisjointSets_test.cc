// SPDX-License-Identifier: BSD-3-Clause
#include "Parallel/DisjointSets.hh"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

namespace hfr::par {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// Smallest number that each can be led to from, by passes over the pairs until nothing changes.
std::vector<std::uint32_t> smallest_by_passes(std::uint32_t n, const std::vector<Pair>& pairs) {
  std::vector<std::uint32_t> name(n);
  std::iota(name.begin(), name.end(), 0U);
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [i, j] : pairs) {
      const std::uint32_t least = std::min(name[i], name[j]);
      changed = changed || name[i] != least || name[j] != least;
      name[i] = name[j] = least;
    }
  }
  return name;
}

TEST(DisjointSets, EveryNumberIsByItselfAtFirst) {
  DisjointSets<std::uint32_t> sets(5);
  EXPECT_EQ(sets.size(), 5U);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(sets.find(i), i);
  EXPECT_EQ(DisjointSets<std::uint32_t>(0).size(), 0U);
}

TEST(DisjointSets, SetIsNamedByItsSmallestNumber) {
  DisjointSets<std::uint32_t> sets(6);
  EXPECT_TRUE(sets.join(4, 5));
  EXPECT_TRUE(sets.join(3, 5));
  EXPECT_EQ(sets.find(5), 3U);
  EXPECT_TRUE(sets.join(1, 4));
  for (const std::uint32_t i : {1U, 3U, 4U, 5U}) EXPECT_EQ(sets.find(i), 1U);
  EXPECT_EQ(sets.find(0), 0U);
  EXPECT_EQ(sets.find(2), 2U);
}

TEST(DisjointSets, JoinTellsWhetherThereWereTwoSets) {
  DisjointSets<std::size_t> sets(3);
  EXPECT_FALSE(sets.join(1, 1));
  EXPECT_TRUE(sets.join(2, 1));
  EXPECT_FALSE(sets.join(1, 2));
  EXPECT_TRUE(sets.join(0, 2));
  EXPECT_FALSE(sets.join(1, 0));
}

TEST(DisjointSets, AreThoseOfPassesOverThePairsInAnyOrder) {
  std::mt19937 engine(7);
  std::size_t n_sets = 0, n_joined = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const std::uint32_t n = 1 + engine() % 60;
    std::vector<Pair> pairs(engine() % n);
    for (auto& [i, j] : pairs) i = engine() % n, j = engine() % n;
    const std::vector<std::uint32_t> wanted = smallest_by_passes(n, pairs);
    for (int order = 0; order < 3; ++order) {
      std::shuffle(pairs.begin(), pairs.end(), engine);
      DisjointSets<std::uint32_t> sets(n);
      std::size_t n_left = n;
      for (const auto& [i, j] : pairs) n_left -= sets.join(i, j) ? 1 : 0;
      std::size_t n_names = 0;
      for (std::uint32_t i = 0; i < n; ++i) {
        ASSERT_EQ(sets.find(i), wanted[i]);
        n_names += wanted[i] == i ? 1 : 0;
      }
      ASSERT_EQ(n_left, n_names);
      n_sets += n_names;
      n_joined += n - n_names;
    }
  }
  EXPECT_GT(n_sets, 500U);
  EXPECT_GT(n_joined, 500U);
}

}  // namespace
}  // namespace hfr::par
