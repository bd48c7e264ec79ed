// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_SLICES_HH
#define HFR_DISTRIBUTED_SLICES_HH

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace hfr::mpi {

/// Ranges of numbers that follow on one another, one a rank; they may be empty.
class Slices {
 public:
  Slices() = default;
  /// `begins`: of each, and the end of the last one.
  explicit Slices(std::vector<std::uint64_t> begins) : begins_(std::move(begins)) {}
  /// Of the numbers below n, about as many each.
  static Slices even(std::size_t n_ranks, std::uint64_t n) {
    std::vector<std::uint64_t> begins;
    for (std::uint64_t r = 0; r <= n_ranks; ++r) begins.push_back((r * n + n_ranks - 1) / n_ranks);
    return Slices(std::move(begins));
  }

  std::uint64_t begin(int rank) const { return begins_[static_cast<std::size_t>(rank)]; }
  std::size_t size(int rank) const { return static_cast<std::size_t>(begin(rank + 1) - begin(rank)); }
  /// Of a number that is in one of them.
  std::size_t rank_of(std::uint64_t number) const {
    return static_cast<std::size_t>(std::upper_bound(begins_.begin(), begins_.end(), number) -
                                    begins_.begin()) -
           1;
  }

 private:
  std::vector<std::uint64_t> begins_;
};

}  // namespace hfr::mpi

#endif
