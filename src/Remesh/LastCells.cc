// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/LastCells.hh"

#include <algorithm>

#include "Remesh/MayRise.hh"
#include "Remesh/Neighbourhoods.hh"
#include "Remesh/PatchSearch.hh"
#include "Remesh/Rise.hh"

namespace hfr {

bool improve_last_cells(const Run& run, const LastCellsEffort& effort, std::span<const TargetAngle> targets) {
  if (!run.strategy.patch.enabled && !run.strategy.neighbourhoods) return false;
  const auto smallest = [&] { return smallest_that_may_rise(run, kLargestGoal); };
  const double at_first = smallest();
  double now = at_first;
  for (const TargetAngle& target : targets) {
    if (target.degrees > effort.up_to || run.control.stopped()) break;
    if (now >= target.degrees) continue;
    if (share_that_may_rise(run, target.degrees, target.largest_share) > target.largest_share) break;
    const auto search = [&](const std::vector<PatchEffort>& efforts) {
      for (const PatchEffort& how : efforts)
        if (now < target.degrees && search_patches(run, target.degrees, how)) now = smallest();
    };
    search(effort.patches_first);
    double before = 0;
    std::size_t n_flat_before = kNoLimit;
    // Of many cells that are all but flat, a few are worked on at a time.
    const auto is_worth_going_on = [&] {
      if (now > angle_to_rise(before, effort.again, target.degrees)) return true;
      return now > effort.again * before && run.n_below(kPlainGoal) < n_flat_before;
    };
    while (now < target.degrees && is_worth_going_on() && !run.control.stopped()) {
      before = now;
      if (now < kPlainGoal) n_flat_before = run.n_below(kPlainGoal);
      const auto& neighbourhoods = run.strategy.neighbourhoods;
      const std::size_t few = neighbourhoods ? neighbourhoods->few : 0;
      improve_neighbourhoods(run, neighbourhoods, degrees_with_few_that_may_rise(run, target.degrees, few));
      now = smallest();
    }
    if (target.degrees <= effort.patches_up_to) search(effort.patches);
    if (now < target.degrees) break;
  }
  // An invalid cell has not risen by staying what it is.
  return now > std::max(at_first, effort.rise * at_first);
}

}  // namespace hfr
