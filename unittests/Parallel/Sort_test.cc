// SPDX-License-Identifier: BSD-3-Clause
#include "Parallel/Sort.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace hfr::par {
namespace {

std::vector<KeyIndex> random_items(std::size_t n, std::uint64_t mask) {
  std::mt19937_64 engine(n + mask);
  std::vector<KeyIndex> items(n);
  for (std::size_t i = 0; i < n; ++i) items[i] = {engine() & mask, static_cast<std::uint32_t>(i)};
  return items;
}

TEST(StableSort, IsThatOfTheStandardLibraryForAnyNumberOfThreads) {
  std::vector<KeyIndex> scratch;
  std::size_t n_equal = 0;
  for (const std::uint64_t mask : {0xffULL, 0xff00ff00ULL, ~0ULL, 0ULL}) {
    for (const std::size_t n : {0U, 1U, 2U, 100U, 511U, 512U, 513U, 5000U, 70000U}) {
      std::vector<KeyIndex> wanted = random_items(n, mask);
      std::stable_sort(wanted.begin(), wanted.end(),
                       [](const KeyIndex& a, const KeyIndex& b) { return a.key < b.key; });
      for (int threads : {1, 2, 3, 7}) {
        std::vector<KeyIndex> items = random_items(n, mask);
        stable_sort({threads, 1}, items, scratch);
        ASSERT_EQ(items.size(), n);
        for (std::size_t i = 0; i < n; ++i) {
          ASSERT_EQ(items[i].key, wanted[i].key);
          ASSERT_EQ(items[i].index, wanted[i].index);
          if (i > 0 && items[i].key == items[i - 1].key) ++n_equal;
        }
      }
    }
  }
  EXPECT_GT(n_equal, 1000U) << "no equal keys, so nothing shows that the sort is stable";
}

}  // namespace
}  // namespace hfr::par
