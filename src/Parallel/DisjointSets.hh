// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_PARALLEL_DISJOINT_SETS_HH
#define HFR_PARALLEL_DISJOINT_SETS_HH

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace hfr::par {

/// The numbers 0 … n-1 in sets that are joined two at a time (union-find, by halving paths). A set is named
/// by its smallest number, whatever the order of joins: results that go by names are the same however the
/// pairs were found. For one thread; not even find() may be called by two at once.
template <std::unsigned_integral T>
class DisjointSets {
 public:
  /// Every number by itself. All numbers must fit into T.
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), T{0}); }

  std::size_t size() const { return parent_.size(); }

  /// The smallest number of the set that has i.
  T find(T i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Makes one set of the two that have i and j. False when that is what they were.
  bool join(T i, T j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
    return i != j;
  }

 private:
  std::vector<T> parent_;
};

}  // namespace hfr::par

#endif
