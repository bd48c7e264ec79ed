// SPDX-License-Identifier: BSD-3-Clause
// The same for every thread library: one that is compiled has to pass all of it.
#include "Parallel/Parallel.hh"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace hfr::par {
namespace {

class Threads : public testing::TestWithParam<int> {
 protected:
  Policy policy() const { return {GetParam(), 1}; }
};
INSTANTIATE_TEST_SUITE_P(Parallel, Threads, testing::Values(1, 2, 3, 7, 16));

TEST_P(Threads, ForEachVisitsEachItemOnce) {
  for (const std::size_t n : {0U, 1U, 2U, 5U, 16U, 1000U}) {
    std::vector<std::atomic<int>> visits(n);
    for_each(policy(), n, [&](std::size_t i) { ++visits[i]; });
    for_each_dynamic(policy(), n, 3, [&](std::size_t i) { ++visits[i]; });
    for (const auto& count : visits) EXPECT_EQ(count, 2);
  }
}

TEST_P(Threads, PartsAreContiguousAndEven) {
  const int n_parts = GetParam();
  for (const std::size_t n : {0U, 3U, 100U, 101U}) {
    EXPECT_EQ(part_begin(n, n_parts, 0), 0U);
    EXPECT_EQ(part_begin(n, n_parts, n_parts), n);
    for (int p = 0; p < n_parts; ++p) {
      const std::size_t size = part_begin(n, n_parts, p + 1) - part_begin(n, n_parts, p);
      EXPECT_LE(size, n / static_cast<std::size_t>(n_parts) + 1);
      EXPECT_GE(size, n / static_cast<std::size_t>(n_parts));
    }
  }
}

TEST_P(Threads, ReduceGivesTheSerialResult) {
  const auto value = [](std::size_t i) { return (i * 7919) % 1009; };
  std::size_t sum = 0;
  std::size_t most = 0;
  for (std::size_t i = 0; i < 5000; ++i) {
    sum += value(i);
    most = std::max(most, value(i));
  }
  EXPECT_EQ(reduce(policy(), 5000, std::size_t{0}, value, std::plus<>{}), sum);
  EXPECT_EQ(reduce(policy(), 5000, std::size_t{0}, value,
                   [](std::size_t a, std::size_t b) { return std::max(a, b); }),
            most);
  EXPECT_EQ(reduce(policy(), 0, std::size_t{0}, value, std::plus<>{}), 0U);
}

/// Bools of a std::vector share words: of pieces that end at the same time, one would lose what the other
/// found, in one of a few hundred reductions.
TEST_P(Threads, ReducesToABoolThatNoPieceLoses) {
  constexpr std::size_t kItems = 64;
  for (std::size_t one = 0; one < 100 * kItems; ++one)
    ASSERT_TRUE(reduce(
        policy(), kItems, false, [&](std::size_t i) { return i == one % kItems; }, std::logical_or<>{}))
        << one;
}

TEST_P(Threads, ForTargetsCoversThemOnceForAnyNumberOfItems) {
  for (const std::size_t n_targets : {0U, 1U, 5U, 100U})
    for (const std::size_t n_items : {0U, 3U, 1000U}) {
      std::vector<std::atomic<int>> visits(n_targets);
      for_targets(policy(), n_items, n_targets, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (const auto& count : visits) EXPECT_EQ(count, 1);
    }
}

TEST_P(Threads, RangesAreInOrderAndLeaveNothingOut) {
  for (const std::size_t n : {0U, 1U, 7U, 1000U}) {
    std::vector<std::atomic<int>> visits(n);
    for_ranges(policy(), n, [&](std::size_t begin, std::size_t end) {
      EXPECT_LE(begin, end);
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    for (const auto& count : visits) EXPECT_EQ(count, 1);
  }
}

TEST_P(Threads, CompactKeepsTheOrder) {
  const auto kept = compact<std::uint32_t>(policy(), 1000, [](std::size_t i) { return i % 3 == 1; });
  ASSERT_EQ(kept.size(), 333U);
  for (std::size_t k = 0; k < kept.size(); ++k) EXPECT_EQ(kept[k], 3 * k + 1);
}

TEST_P(Threads, ExceptionOfTheFirstPartThatFailsArrives) {
  std::atomic<int> others{0};
  const auto run = [&] {
    parts(8, [&](int part) {
      if (part == 2 || part == 5) throw std::runtime_error(std::to_string(part));
      ++others;
    });
  };
  try {
    run();
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "2");
  }
  EXPECT_EQ(others, 6);
}

TEST(ThreadCount, ShortLoopsStayOnTheCaller) {
  EXPECT_EQ(thread_count({4, 100}, 99), 1);
  EXPECT_EQ(thread_count({1, 1}, 1000), 1);
  EXPECT_EQ(thread_count({4, 100}, 100), HFR_TEST_HAS_THREADS ? 4 : 1);
  EXPECT_GE(Policy::all().threads, 1);
}

/// Each part waits for the other: one thread alone would wait for ever, so it gives up.
TEST(Parts, RunAtTheSameTime) {
  if (!HFR_TEST_HAS_THREADS) GTEST_SKIP() << "built without threads";
  std::atomic<int> n_here{0};
  std::array<bool, 2> met{};
  parts(2, [&](int part) {
    ++n_here;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (n_here < 2 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    met[static_cast<std::size_t>(part)] = n_here == 2;
  });
  EXPECT_TRUE(met[0] && met[1]);
}

TEST(ExclusiveScan, SumsWhatStandsBefore) {
  std::vector<std::size_t> values = {3, 0, 4, 1};
  EXPECT_EQ(exclusive_scan(std::span(values)), 8U);
  EXPECT_EQ(values, (std::vector<std::size_t>{0, 3, 3, 7}));
}

}  // namespace
}  // namespace hfr::par
