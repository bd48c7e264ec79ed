// SPDX-License-Identifier: BSD-3-Clause
// The backend itself: that it interleaves, and that a seed repeats what it did.
#include "Shuffle/Shuffle.hh"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <stdexcept>

#include "Parallel/Interleave.hh"
#include "Parallel/Parallel.hh"

namespace hfr::test {
namespace {

constexpr par::Policy kPolicy = {7, 0};

/// A counter that parts raise by reading and writing it, each with a chance for others in between.
int careless_count(std::uint64_t seed) {
  shuffle(seed);
  int count = 0;
  par::for_each(kPolicy, 70, [&](std::size_t) {
    par::before_shared_access();
    const int now = count;
    par::before_shared_access();
    count = now + 1;
  });
  return count;
}

TEST(Shuffle, CarelessCounterLosesSomeInMostOrders) {
  int n_right = 0;
  std::set<int> counts;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const int count = careless_count(seed);
    EXPECT_EQ(careless_count(seed), count) << "seed " << seed << " does not repeat";
    n_right += count == 70 ? 1 : 0;
    counts.insert(count);
  }
  EXPECT_LT(n_right, 60);
  EXPECT_GT(counts.size(), 10U);
}

TEST(Shuffle, PartsRunInManyOrdersAndEachItemOnce) {
  std::set<std::vector<int>> orders;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    shuffle(seed);
    std::vector<int> order;
    par::parts(4, [&](int part) { order.push_back(part); });
    orders.insert(order);
    std::vector<int> visits(200, 0);
    par::for_each_dynamic(kPolicy, visits.size(), 3, [&](std::size_t i) { ++visits[i]; });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), 200);
  }
  EXPECT_GT(orders.size(), 20U) << "of 24";
}

TEST(Shuffle, LoopWithinALoopAndExceptionOfTheFirstPartThatFails) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    shuffle(seed);
    std::vector<int> visits(49, 0);
    par::parts(7, [&](int outer) {
      par::parts(7, [&](int inner) {
        par::before_shared_access();
        ++visits[static_cast<std::size_t>(7 * outer + inner)];
      });
    });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), 49);
    try {
      par::parts(8, [&](int part) {
        par::before_shared_access();
        if (part == 2 || part == 5) throw std::runtime_error(std::to_string(part));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "2");
    }
  }
}

}  // namespace
}  // namespace hfr::test
