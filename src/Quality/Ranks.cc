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
  Bins(std::span<const double> values, par::Policy policy) {
    struct Range {
      double low = std::numeric_limits<double>::infinity(), high = -low;
    };
    const Range all = par::reduce(
        policy, values.size(), Range{},
        [&](std::size_t i) {
          return Range{values[i], values[i]};
        },
        [](Range a, Range b) {
          return Range{b.low < a.low ? b.low : a.low, b.high > a.high ? b.high : a.high};
        });
    low_ = all.low;
    const double range = all.high - low_;
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

std::vector<double> values_at(std::span<const double> values, std::span<const std::size_t> ranks,
                              par::Policy policy) {
  const Bins bins(values, policy);
  const int n_parts = par::thread_count(policy, values.size());
  const auto for_values = [&](int part, auto&& body) {
    par::for_part(values.size(), n_parts, part, [&](std::size_t i) { body(values[i]); });
  };
  struct Binned {
    std::vector<std::size_t> n = std::vector<std::size_t>(kBins, 0);  // by bin
    std::vector<std::vector<double>> members = std::vector<std::vector<double>>(kBins);
  };
  std::vector<Binned> binned(static_cast<std::size_t>(n_parts));  // by part
  par::parts(n_parts, [&](int part) {
    std::vector<std::size_t>& n = binned[static_cast<std::size_t>(part)].n;
    for_values(part, [&](double x) { ++n[bins.of(x)]; });
  });
  std::array<std::size_t, kBins + 1> first{};  // of each bin, in the sorted order
  for (std::size_t i = 0; i < kBins; ++i) {
    first[i + 1] = first[i];
    for (const Binned& part : binned) first[i + 1] += part.n[i];
  }
  const auto bin_with = [&](std::size_t rank) {
    return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), rank) - first.begin()) - 1;
  };
  std::array<std::uint8_t, kBins> is_asked{};
  for (const std::size_t rank : ranks) is_asked[bin_with(rank)] = 1;
  par::parts(n_parts, [&](int part) {
    Binned& mine = binned[static_cast<std::size_t>(part)];
    for (std::size_t i = 0; i < kBins; ++i)
      if (is_asked[i]) mine.members[i].reserve(mine.n[i]);
    for_values(part, [&](double x) {
      if (const std::size_t bin = bins.of(x); is_asked[bin]) mine.members[bin].push_back(x);
    });
  });
  std::vector<double> found;
  for (const std::size_t rank : ranks) {
    const std::size_t bin = bin_with(rank);
    std::vector<double>& members = binned[0].members[bin];  // of all parts, once they are asked for
    for (std::size_t part = 1; part < binned.size(); ++part) {
      std::vector<double>& more = binned[part].members[bin];
      members.insert(members.end(), more.begin(), more.end());
      more.clear();
    }
    const auto at = members.begin() + static_cast<std::ptrdiff_t>(rank - first[bin]);
    std::nth_element(members.begin(), at, members.end());
    found.push_back(*at);
  }
  return found;
}

}  // namespace hfr::detail
