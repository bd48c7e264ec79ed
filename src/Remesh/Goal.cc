// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Goal.hh"

#include "Remesh/LastCells.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/Pipeline.hh"
#include "Remesh/Polish.hh"
#include "Remesh/Targets.hh"
#include "Remesh/Trial.hh"

namespace hfr {
namespace {

double smallest(const Run& run) { return smallest_that_may_rise(run, kLargestGoal); }

/// The cells that miss the goal; what misses it then as far as it goes, and the goal once more if that
/// helped.
bool attempt(const Run& run, double degrees, std::span<const TargetAngle> targets) {
  const Strategy& strategy = run.strategy;
  if (polish(run, strategy.polish, degrees)) return true;
  const double missed_at = smallest(run);
  raise_to_targets(run, targets);
  if (!run.control.stopped()) improve_last_cells(run, strategy.last_cells, targets);
  return !run.control.stopped() && smallest(run) > missed_at && polish(run, strategy.polish, degrees);
}

/// Where the bounds on cells were in the way: works on the cells that miss the goal within those that were
/// asked for alone. True when what was done stays.
bool attempt_beyond(const Run& run, const GoalEffort& goal) {
  if (!run.findings.met_cell_bound || run.control.stopped()) return false;
  run.findings.forget_cell_bound();
  Trial trial(run, goal.degrees);
  return attempt(run.within(run.strategy.bounds_asked), goal.degrees, run.strategy.targets.targets) ||
         trial.settle();
}

}  // namespace

void reach_in_turn(const Run& run, const GoalEffort& goal, Best& best) {
  const std::span<const TargetAngle> all = run.strategy.targets.targets;
  for (std::size_t i = 0; i < all.size() && !run.control.stopped(); ++i) {
    const double now = smallest(run), degrees = all[i].degrees;
    if (now >= degrees) continue;
    const auto targets = all.first(i + 1);
    const bool many_miss = share_that_may_rise(run, degrees, goal.few_miss) > goal.few_miss;
    if (many_miss) improve_all(run, now, targets);
    attempt(run, degrees, targets);
    // What more targets bring may cost more of the other cells than it may.
    best.note();
    if (smallest(run) < degrees) return;
  }
}

bool reach_goal(const Run& run, const GoalEffort& goal, bool cells_are_untouched) {
  const Strategy& strategy = run.strategy;
  if (attempt(run, goal.degrees, strategy.targets.targets)) return true;
  CellBounds bounds = run.bounds;
  if (attempt_beyond(run, goal)) {
    if (run.n_below(goal.degrees) == 0) return true;
    bounds = strategy.bounds_asked;
  }
  if (run.control.stopped() || !goal.goes_on) return false;
  const bool many_miss =
      cells_are_untouched && share_that_may_rise(run, goal.degrees, goal.few_miss) > goal.few_miss;
  if (!run.surface && !many_miss) return false;
  const Run further = run.within(bounds);
  Trial trial(run, goal.degrees);
  if (!run.surface)
    improve_all(further, smallest(run), strategy.targets.targets);
  else if (cells_are_untouched)
    improve_all(further, smallest(run), strategy.targets.beyond);
  else
    raise_worst_angles(further, smallest(run), strategy.targets.beyond);
  if (polish(further, strategy.polish, goal.degrees)) return true;
  trial.settle();
  return false;
}

}  // namespace hfr
