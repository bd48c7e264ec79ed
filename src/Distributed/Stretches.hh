// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_STRETCHES_HH
#define HFR_DISTRIBUTED_STRETCHES_HH

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "Distributed/Comm.hh"

namespace hfr::mpi {

/// Stretches of a curve, or of another order, one a rank, with about as many of the things on each that lie
/// on it.
template <class Place = std::uint64_t>
class Stretches {
 public:
  /// Of n things of this rank, place_of(i) is where they lie. All take part.
  template <class PlaceOf>
  Stretches(Comm& comm, std::size_t n, PlaceOf&& place_of) {
    constexpr std::size_t kSamples = 1024;  // of each rank
    std::vector<Place> sample;
    const std::size_t step = std::max<std::size_t>(n / kSamples, 1);
    for (std::size_t i = 0; i < n; i += step) sample.push_back(place_of(i));
    sample = comm.all_gather(std::span<const Place>(sample));
    std::sort(sample.begin(), sample.end());
    for (std::size_t r = 1; r < comm.n_ranks() && !sample.empty(); ++r)
      begins_.push_back(sample[r * sample.size() / comm.n_ranks()]);
  }

  std::int32_t rank_of(const Place& place) const {
    const auto at = std::upper_bound(begins_.begin(), begins_.end(), place);
    return static_cast<std::int32_t>(at - begins_.begin());
  }

 private:
  std::vector<Place> begins_;  // of all but the first
};

}  // namespace hfr::mpi

#endif
