// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/ByteTable.hh"

#include <gtest/gtest.h>

#include <map>

namespace hfr::test {
namespace {

/// Few of many slots and many of them, in no order, some set again.
TEST(ByteTable, HasWhatWasSetAndOtherwiseWhatAllHave) {
  constexpr std::size_t kSlots = 5000;
  for (const std::size_t n_set : {0, 1, 7, 18, 19, 20, 700, 5000}) {
    ByteTable table(kSlots, n_set, 63);
    std::map<Index, std::uint8_t> expected;
    for (std::uint64_t i = 0; expected.size() < n_set; ++i) {
      const auto slot = static_cast<Index>(n_set == kSlots ? i : mix64(i) % kSlots);
      const auto byte = static_cast<std::uint8_t>(mix64(i + 17) % 256);
      table.set(slot, byte);
      expected[slot] = byte;
      if (i % 3 == 0) {
        table.set(slot, 2);
        expected[slot] = 2;
      }
    }
    for (Index slot = 0; slot < kSlots; ++slot) {
      const auto at = expected.find(slot);
      ASSERT_EQ(table[slot], at == expected.end() ? 63 : at->second) << slot << " with " << n_set;
    }
  }
}

TEST(ByteTable, ThreadsMaySetManySlotsOnly) {
  EXPECT_FALSE(ByteTable(100'000, 10, 0).is_for_threads());
  EXPECT_TRUE(ByteTable(100'000, 10'000, 0).is_for_threads());
  EXPECT_FALSE(ByteTable(0, 0, 0).is_for_threads()) << "nothing can be set";
}

/// Slots whose places are the same come one after another, also past the end of the table.
TEST(ByteTable, SlotsOfOnePlaceAreKeptApart) {
  ByteTable table(1'000'000, 7, 0);
  std::vector<Index> slots;
  for (Index slot = 0; slots.size() < 7; ++slot)
    if (mix64(slot) % 16 == 15) slots.push_back(slot);
  for (std::size_t i = 0; i < slots.size(); ++i) table.set(slots[i], static_cast<std::uint8_t>(i + 1));
  for (std::size_t i = 0; i < slots.size(); ++i) EXPECT_EQ(table[slots[i]], i + 1);
  EXPECT_EQ(table[slots.back() + 1], 0);
}

}  // namespace
}  // namespace hfr::test
