// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_RANKS_HH
#define HFR_QUALITY_RANKS_HH

#include <cstddef>
#include <span>
#include <vector>

#include "Parallel/Parallel.hh"

/// Order statistics of many numbers; internal to this folder.
namespace hfr::detail {

/// The values at `ranks` (ascending, counted from 0, below values.size()) of the sorted order. Values are
/// counted in bins between the smallest and the largest one, and only those of a bin with a rank are sorted
/// out. No value is NaN.
std::vector<double> values_at(std::span<const double> values, std::span<const std::size_t> ranks,
                              par::Policy policy);

}  // namespace hfr::detail

#endif
