// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/ChunkedArray.hh"

#include <gtest/gtest.h>

namespace hfr::test {
namespace {

TEST(ChunkedArray, HoldsWhatWasPushedAndAppendedInOrder) {
  constexpr std::size_t kChunk = ChunkedArray<int>::kChunk;
  for (const std::size_t n_first : {std::size_t{0}, std::size_t{5}, kChunk, kChunk + 7, 3 * kChunk}) {
    for (const std::size_t n_second : {std::size_t{0}, std::size_t{3}, kChunk, 2 * kChunk + 1}) {
      ChunkedArray<int> all, more;
      for (std::size_t i = 0; i < n_first; ++i) all.push_back(static_cast<int>(i));
      for (std::size_t i = 0; i < n_second; ++i) more.push_back(static_cast<int>(n_first + i));
      all.append(std::move(more));
      all.push_back(-1);
      ASSERT_EQ(all.size(), n_first + n_second + 1);
      for (std::size_t i = 0; i < n_first + n_second; ++i) ASSERT_EQ(all[i], static_cast<int>(i));
      EXPECT_EQ(all[n_first + n_second], -1);
      EXPECT_EQ(more.size(), 0U);
    }
  }
}

TEST(ChunkedArray, WhatItHoldsStaysWhereItIsWhileItGrows) {
  ChunkedArray<int> all;
  all.push_back(1);
  const int* const first = &all[0];
  for (int i = 0; i < 10000; ++i) all.push_back(i);
  EXPECT_EQ(&all[0], first);
}

}  // namespace
}  // namespace hfr::test
