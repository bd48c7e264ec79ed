// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_RANK_SETS_HH
#define HFR_DISTRIBUTED_RANK_SETS_HH

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/TupleMap.hh"

namespace hfr::mpi {

/// Calls visit(rank) for each rank in a set of bits, ascending.
template <class Visit>
void for_ranks(std::span<const std::uint64_t> set, Visit&& visit) {
  for (std::size_t w = 0; w < set.size(); ++w)
    for (std::uint64_t bits = set[w]; bits != 0; bits &= bits - 1)
      visit(static_cast<int>(64 * w) + std::countr_zero(bits));
}

/// A set of ranks for each of many things. Few sets are different: each is kept once, a bit a rank, and a
/// thing has its number, which is 4 bytes for any number of ranks. Sets that no thing has any more stay.
class RankSets {
 public:
  using Id = std::uint32_t;
  static constexpr Id kEmpty = 0;

  RankSets() = default;
  RankSets(std::size_t n, int n_ranks)
      : words_((static_cast<std::size_t>(n_ranks) + 63) / 64), ids_(n, kEmpty), sets_(words_, 0) {}

  std::size_t words() const { return words_; }
  /// The same for equal sets of this object alone.
  Id id(std::size_t i) const { return ids_[i]; }
  /// Until a set is changed.
  std::span<const std::uint64_t> operator[](std::size_t i) const {
    return {sets_.data() + ids_[i] * words_, words_};
  }
  bool has(std::size_t i, int rank) const { return (word_of((*this)[i], rank) >> (rank % 64) & 1) != 0; }
  bool is_only(std::size_t i, int rank) const {
    const auto set = (*this)[i];
    bool others = false;
    for (std::size_t w = 0; w < words_; ++w)
      others = others || (set[w] & ~(w == static_cast<std::size_t>(rank) / 64 ? bit(rank) : 0)) != 0;
    return !others;
  }
  /// One more at the end.
  void append_only(int rank) { ids_.push_back(only(rank)); }
  /// By thing, for whoever moves things; kEmpty is that of the empty set.
  std::vector<Id>& ids() { return ids_; }
  void set_only(std::size_t i, int rank) { ids_[i] = only(rank); }
  void add(std::size_t i, int rank) {
    if (has(i, rank)) return;
    start_from(i);
    scratch_[static_cast<std::size_t>(rank) / 64] |= bit(rank);
    ids_[i] = number();
  }
  /// `set`: none of this object.
  void add(std::size_t i, std::span<const std::uint64_t> set) {
    bool has_all = true;
    const auto mine = (*this)[i];
    for (std::size_t w = 0; w < words_; ++w) has_all = has_all && (set[w] & ~mine[w]) == 0;
    if (has_all) return;
    start_from(i);
    for (std::size_t w = 0; w < words_; ++w) scratch_[w] |= set[w];
    ids_[i] = number();
  }
  void set(std::size_t i, std::span<const std::uint64_t> set) {
    scratch_.assign(set.begin(), set.end());
    ids_[i] = number();
  }

 private:
  static std::uint64_t bit(int rank) { return std::uint64_t{1} << (rank % 64); }
  static std::uint64_t word_of(std::span<const std::uint64_t> set, int rank) {
    return set[static_cast<std::size_t>(rank) / 64];
  }
  void start_from(std::size_t i) { scratch_.assign((*this)[i].begin(), (*this)[i].end()); }
  Id only(int rank) {
    if (rank == last_only_.first) return last_only_.second;
    scratch_.assign(words_, 0);
    scratch_[static_cast<std::size_t>(rank) / 64] = bit(rank);
    last_only_ = {rank, number()};
    return last_only_.second;
  }
  /// Of the set in scratch_, which is not empty.
  Id number() {
    std::uint64_t hash = 0;
    for (std::uint64_t word : scratch_) hash = mix64(hash ^ word);
    const auto [begin, end] = numbers_.equal_range(hash);
    for (auto at = begin; at != end; ++at)
      if (std::equal(scratch_.begin(), scratch_.end(),
                     sets_.begin() + static_cast<std::ptrdiff_t>(at->second * words_)))
        return at->second;
    const auto id = static_cast<Id>(sets_.size() / words_);
    sets_.insert(sets_.end(), scratch_.begin(), scratch_.end());
    numbers_.emplace(hash, id);
    return id;
  }

  std::size_t words_ = 1;
  std::vector<Id> ids_;                                 // by thing
  std::vector<std::uint64_t> sets_ = {0};               // by number; the first is empty
  std::unordered_multimap<std::uint64_t, Id> numbers_;  // by hash, of all but the empty one
  std::pair<int, Id> last_only_ = {-1, kEmpty};
  std::vector<std::uint64_t> scratch_;
};

/// One set by itself.
class RankSet {
 public:
  explicit RankSet(std::size_t words) : bits_(words, 0) {}
  void clear() { bits_.assign(bits_.size(), 0); }
  void add(std::span<const std::uint64_t> set) {
    for (std::size_t w = 0; w < bits_.size(); ++w) bits_[w] |= set[w];
  }
  void remove(int rank) { bits_[static_cast<std::size_t>(rank) / 64] &= ~(std::uint64_t{1} << (rank % 64)); }
  void remove(std::span<const std::uint64_t> set) {
    for (std::size_t w = 0; w < bits_.size(); ++w) bits_[w] &= ~set[w];
  }
  bool empty() const {
    for (std::uint64_t word : bits_)
      if (word != 0) return false;
    return true;
  }
  std::span<const std::uint64_t> bits() const { return bits_; }

 private:
  std::vector<std::uint64_t> bits_;
};

}  // namespace hfr::mpi

#endif
