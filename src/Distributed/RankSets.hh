// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_RANK_SETS_HH
#define HFR_DISTRIBUTED_RANK_SETS_HH

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"

namespace hfr::mpi {

/// Calls visit(rank) for each rank in a set of bits, ascending.
template <class Visit>
void for_ranks(std::span<const std::uint64_t> set, Visit&& visit) {
  for (std::size_t w = 0; w < set.size(); ++w)
    for (std::uint64_t bits = set[w]; bits != 0; bits &= bits - 1)
      visit(static_cast<int>(64 * w) + std::countr_zero(bits));
}

/// A set of ranks for each of many things: a bit a rank.
class RankSets {
 public:
  RankSets() = default;
  RankSets(std::size_t n, int n_ranks)
      : words_((static_cast<std::size_t>(n_ranks) + 63) / 64), bits_(n * words_, 0) {}

  std::size_t words() const { return words_; }
  std::span<const std::uint64_t> operator[](std::size_t i) const {
    return {bits_.data() + i * words_, words_};
  }
  bool has(std::size_t i, int rank) const {
    return (bits_[i * words_ + static_cast<std::size_t>(rank) / 64] >> (rank % 64) & 1) != 0;
  }
  bool is_only(std::size_t i, int rank) const {
    bool others = false;
    for (std::size_t w = 0; w < words_; ++w) {
      const std::uint64_t mine =
          w == static_cast<std::size_t>(rank) / 64 ? std::uint64_t{1} << (rank % 64) : 0;
      others = others || (bits_[i * words_ + w] & ~mine) != 0;
    }
    return !others;
  }
  /// One more at the end.
  void append_only(int rank) {
    bits_.resize(bits_.size() + words_, 0);
    add(bits_.size() / words_ - 1, rank);
  }
  /// As open_gaps() of HalfFace/Writer.hh, with empty sets between.
  void open_gaps(std::span<const VertexHandle> to, std::size_t n) {
    bits_.resize(n * words_, 0);
    std::size_t i = to.size();
    for (std::size_t place = n; place-- > 0;) {
      const bool is_old = i > 0 && to[i - 1].idx() == place;
      if (is_old && --i == place) return;
      for (std::size_t w = 0; w < words_; ++w) bits_[place * words_ + w] = is_old ? bits_[i * words_ + w] : 0;
    }
  }
  void set_only(std::size_t i, int rank) {
    for (std::size_t w = 0; w < words_; ++w) bits_[i * words_ + w] = 0;
    add(i, rank);
  }
  void add(std::size_t i, int rank) {
    bits_[i * words_ + static_cast<std::size_t>(rank) / 64] |= std::uint64_t{1} << (rank % 64);
  }
  void add(std::size_t i, std::span<const std::uint64_t> set) {
    for (std::size_t w = 0; w < words_; ++w) bits_[i * words_ + w] |= set[w];
  }
  void set(std::size_t i, std::span<const std::uint64_t> set) {
    for (std::size_t w = 0; w < words_; ++w) bits_[i * words_ + w] = set[w];
  }

 private:
  std::size_t words_ = 1;
  std::vector<std::uint64_t> bits_;
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
