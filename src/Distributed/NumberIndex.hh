// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_NUMBER_INDEX_HH
#define HFR_DISTRIBUTED_NUMBER_INDEX_HH

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "HalfFace/Handles.hh"

namespace hfr::mpi {

/// Where a number stands in a list without repetition: an open hash table, two to four entries of 16 bytes a
/// number.
class NumberIndex {
 public:
  static constexpr Index kNone = std::numeric_limits<Index>::max();

  NumberIndex() : NumberIndex(0) {}
  /// Room for n numbers.
  explicit NumberIndex(std::size_t n)
      : shift_(63 - static_cast<int>(std::bit_width(n))), entries_(std::size_t{2} << std::bit_width(n)) {}

  /// False where the number is there already.
  bool insert(std::uint64_t number, Index at) {
    Entry& entry = entries_[find(number)];
    if (entry.at != kNone) return false;
    entry = {number, at};
    return true;
  }
  /// kNone where it is not there.
  Index operator[](std::uint64_t number) const { return entries_[find(number)].at; }

 private:
  struct Entry {
    std::uint64_t number = 0;
    Index at = kNone;
  };

  /// Its entry, or the free one where it would be.
  std::size_t find(std::uint64_t number) const {
    std::size_t i = static_cast<std::size_t>(number * 0x9e3779b97f4a7c15ULL >> shift_);
    while (entries_[i].at != kNone && entries_[i].number != number) i = (i + 1) & (entries_.size() - 1);
    return i;
  }

  int shift_;  // leaves as many bits as the table has
  std::vector<Entry> entries_;
};

}  // namespace hfr::mpi

#endif
