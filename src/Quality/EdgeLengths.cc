// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/EdgeLengths.hh"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hfr::detail {

void EdgeLengthBins::add(const EdgeLengthBins& other) {
  if (counts_.size() < other.counts_.size()) counts_.resize(other.counts_.size(), 0);
  for (std::size_t i = 0; i < other.counts_.size(); ++i) counts_[i] += other.counts_[i];
}

Distribution EdgeLengthBins::percentiles(double least, double most) const {
  Distribution d;
  const std::uint64_t n = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
  if (!(most > 0)) return d;
  std::uint64_t below = 0;
  std::size_t next = 0;
  for (std::size_t i = counts_.size(); i-- > 0;) {
    below += counts_[i];
    while (next < kPercentiles.size() &&
           static_cast<double>(below) >= kPercentiles[next] / 100.0 * static_cast<double>(n))
      d.percentiles[next++] = std::clamp(std::sqrt(end_of(top_ - i)), least, most);
  }
  return d;
}

}  // namespace hfr::detail
