// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_EDGE_LENGTHS_HH
#define HFR_QUALITY_EDGE_LENGTHS_HH

#include <bit>
#include <cstdint>
#include <vector>

#include "Quality/Statistics.hh"

/// The part of statistics() that tells how long edges are; internal to this folder.
namespace hfr::detail {

/// Counts of lengths by their squares in bins of equal width, 64 of which double a square. Counts merge
/// exactly.
class EdgeLengthBins {
 public:
  /// No length is larger than `most`.
  explicit EdgeLengthBins(double most) : top_(bin_of(most * most) + 1) {}

  /// The square of a length.
  void add(double length2) {
    const std::uint64_t bin = bin_of(length2);
    const std::uint64_t at = bin < top_ ? top_ - bin : 0;
    if (at >= counts_.size()) counts_.resize(at + 1, 0);
    ++counts_[at];
  }
  void add(const EdgeLengthBins& other);

  /// At most 0.8 % too large, and within [least, most]. Minimum, mean and maximum are left to the caller.
  Distribution percentiles(double least, double most) const;

 private:
  /// Bits of a squared length below those that number its bin: 64 bins double it.
  static constexpr int kShift = 46;

  static std::uint64_t bin_of(double length2) { return std::bit_cast<std::uint64_t>(length2) >> kShift; }
  static double end_of(std::uint64_t bin) { return std::bit_cast<double>((bin + 1) << kShift); }

  std::uint64_t top_;
  std::vector<std::uint64_t> counts_;  // from the bin top_ downwards
};

}  // namespace hfr::detail

#endif
