// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Ranks.hh"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace hfr::detail {
namespace {

constexpr std::size_t kBins = 4096;

/// Bins that ascend with the values, since rounding never turns an order round. Where the range is too wide
/// for a quotient all is in the first one.
class Bins {
 public:
  explicit Bins(std::span<const double> values) {
    double high = -std::numeric_limits<double>::infinity();
    low_ = std::numeric_limits<double>::infinity();
    for (const double x : values) {
      low_ = x < low_ ? x : low_;
      high = x > high ? x : high;
    }
    const double range = high - low_;
    if (range > 0 && range <= std::numeric_limits<double>::max()) scale_ = kBins / range;
    if (!(scale_ <= std::numeric_limits<double>::max())) scale_ = 0;
  }

  std::size_t of(double x) const {
    return scale_ > 0 ? std::min(static_cast<std::size_t>((x - low_) * scale_), kBins - 1) : 0;
  }

 private:
  double low_ = 0;
  double scale_ = 0;
};

}  // namespace

std::vector<double> values_at(std::span<const double> values, std::span<const std::size_t> ranks) {
  const Bins bins(values);
  std::array<std::size_t, kBins + 1> first{};  // of each bin, in the sorted order
  for (const double x : values) ++first[bins.of(x) + 1];
  for (std::size_t i = 0; i < kBins; ++i) first[i + 1] += first[i];
  const auto bin_with = [&](std::size_t rank) {
    return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), rank) - first.begin()) - 1;
  };
  std::array<std::uint8_t, kBins> is_asked{};
  for (const std::size_t rank : ranks) is_asked[bin_with(rank)] = 1;
  std::vector<std::vector<double>> members(kBins);
  for (std::size_t i = 0; i < kBins; ++i)
    if (is_asked[i]) members[i].reserve(first[i + 1] - first[i]);
  for (const double x : values)
    if (const std::size_t bin = bins.of(x); is_asked[bin]) members[bin].push_back(x);
  std::vector<double> found;
  for (const std::size_t rank : ranks) {
    const std::size_t bin = bin_with(rank);
    const auto at = members[bin].begin() + static_cast<std::ptrdiff_t>(rank - first[bin]);
    std::nth_element(members[bin].begin(), at, members[bin].end());
    found.push_back(*at);
  }
  return found;
}

}  // namespace hfr::detail
