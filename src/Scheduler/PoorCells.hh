// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_POOR_CELLS_HH
#define HFR_SCHEDULER_POOR_CELLS_HH

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "Scheduler/Workspace.hh"

namespace hfr {

/// The cells below a value, kept from one call to the next: what was touched meanwhile is looked at, the rest
/// is not, unless a look at all is quicker.
class PoorCells {
 public:
  /// Ascending slots whose quality is below the value. Empties the workspace's list of touched cells.
  std::span<const Index> below(double value, Workspace& work, par::Policy policy) {
    const auto& quality = work.quality;
    if (work.all_touched || value != below_ || (!work.touched.empty() && !is_worth_it(work))) {
      cells_ = par::compact<Index>(policy, quality.size(), [&](std::size_t i) { return quality[i] < value; });
    } else if (!work.touched.empty()) {
      std::erase_if(cells_, [&](Index c) { return !(quality[c] < value); });
      const auto n_old = static_cast<std::ptrdiff_t>(cells_.size());
      for (Index c : work.touched)
        if (quality[c] < value) cells_.push_back(c);
      std::sort(cells_.begin() + n_old, cells_.end());
      std::inplace_merge(cells_.begin(), cells_.begin() + n_old, cells_.end());
      cells_.erase(std::unique(cells_.begin(), cells_.end()), cells_.end());
    }
    below_ = value;
    work.clear_touched();
    return cells_;
  }

 private:
  /// Whether the list is brought up to date sooner than made anew. That goes through the list and sorts what
  /// was touched on one thread; a look at all cells reads them in order, with as many threads as there are.
  bool is_worth_it(const Workspace& work) const {
    constexpr std::size_t kListed = 4, kTouched = 64;  // cells that are read for one
    return kListed * cells_.size() + kTouched * work.touched.size() <= work.quality.size();
  }

  std::vector<Index> cells_;
  double below_ = -std::numeric_limits<double>::infinity();
};

}  // namespace hfr

#endif
