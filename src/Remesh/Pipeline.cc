// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Pipeline.hh"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "Remesh/AnyCost.hh"
#include "Remesh/Best.hh"
#include "Remesh/Bulk.hh"
#include "Remesh/Coarsen.hh"
#include "Remesh/Goal.hh"
#include "Remesh/Jpdc2013.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/Polish.hh"
#include "Remesh/Snapshot.hh"
#include "Remesh/SurfaceRun.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Targets.hh"
#include "Remesh/Trial.hh"
#include "Remesh/Untangle.hh"

namespace hfr {
namespace {

// Shares of a run that are done, for its progress.
constexpr double kUntangled = 0.1;
constexpr double kBulkDone = 0.5;

/// Mends what is inverted or flat.
void mend_invalid(const Run& run) {
  if (run.strategy.untangle) untangle(run, *run.strategy.untangle);
  run.control.set_fraction(kUntangled);
}

/// Whether a cell is below `degrees` that nothing proves to be held where it is.
bool may_rise(const Run& run, double degrees) { return smallest_that_may_rise(run, degrees) < degrees; }

/// Cells below an angle that may rise, before a part of a run, for what more cells would make of them.
struct Low {
  double degrees;
  std::size_t n, n_cells;

  Low(const Run& run, double angle) : degrees(angle), n(count(run, angle)), n_cells(run.n_cells()) {}
  static std::size_t count(const Run& run, double angle) {
    return run.n_below(angle) - n_at_ceiling(run, angle);
  }
  /// Whether there would be none with `most` cells, if those that come mend as many each as those that came.
  bool would_be_gone(const Run& run, double most) const {
    const std::size_t left = count(run, degrees), now = run.n_cells();
    if (left >= n || now <= n_cells) return false;
    return static_cast<double>(n - left) * (most - static_cast<double>(n_cells)) >=
           static_cast<double>(n) * static_cast<double>(now - n_cells);
  }
};

/// Works over all cells for what a default run claims, or for the goal if it is less: where the number of
/// cells was in the way, and with a surface that may change in any case. Goes on while that raises the worst
/// angle, with more cells where they were in the way; once also where a percentile has fallen for it. With
/// `on_promise` also where it would rise with as many cells as there may be in the end. `before`: where such
/// work has begun already, of which the percentiles count; returned for more of it.
std::optional<Best::Beginning> reach_claimed(const Run& run, bool met_cell_bound, bool on_promise = true,
                                             std::optional<Best::Beginning> before = {}) {
  if (!run.strategy.claimed || (!run.surface && !met_cell_bound && run.has_room())) return before;
  const Strategy& claimed = *run.strategy.claimed;
  const GoalEffort& goal = *claimed.goal;
  const auto smallest = [&] { return smallest_that_may_rise(run, goal.degrees); };
  Run part = run.with(claimed);
  const bool may_grow = part.bounds.max > 0 && claimed.bounds_asked.max == 0;
  const auto grow = [&] {
    part.bounds.max = static_cast<std::size_t>(goal.more_cells * static_cast<double>(part.bounds.max));
  };
  int n_grown = 0;
  const auto most_cells = [&] {
    auto most = static_cast<double>(part.bounds.max);
    for (int i = n_grown + 1; i < goal.turns; ++i) most *= goal.more_cells;
    return most;
  };
  const auto brings_no_room = [&] { return part.bounds.max <= run.bounds.max || !part.has_room(); };
  for (; may_grow && brings_no_room() && n_grown + 1 < goal.turns; ++n_grown) grow();
  bool stayed = true;
  while (may_rise(run, goal.degrees) && !run.control.stopped()) {
    if (!before) before.emplace(run);
    const double enough = std::max(smallest(), 0.0) + goal.pays * goal.degrees;
    std::optional<Low> low;
    if (on_promise && may_grow) low.emplace(run, enough);
    run.findings.forget_cell_bound();
    Best best(run, goal.may_fall, Loss::kMadeUpFor, *before);
    reach_in_turn(part, goal, best);
    const bool rose = smallest() > enough, was_in_the_way = run.findings.met_cell_bound || !part.has_room();
    const bool would_rise =
        low && !rose && was_in_the_way && smallest() < goal.degrees && low->would_be_gone(run, most_cells());
    best.settle();
    const bool stays = smallest() > enough;
    if (!would_rise && (!rose || !(stays || stayed))) break;
    if (was_in_the_way) {
      if (!may_grow || ++n_grown >= goal.turns) break;
      grow();
    }
    stayed = stays || would_rise;
  }
  return before;
}

/// For each of these angles, the cells below that may rise.
std::vector<std::size_t> n_that_may_rise(const Run& run, std::span<const double> angles) {
  std::vector<std::size_t> n;
  for (double degrees : angles) n.push_back(Low::count(run, degrees));
  return n;
}

/// Whether only a few cells are what keeps the worst angle below a target: they miss more of those below it
/// than cells may.
bool few_are_far_below(const Run& run, std::size_t target) {
  const TargetEffort& effort = run.strategy.targets;
  if (target <= effort.may_be_missed) return false;
  const double degrees = effort.targets[target - effort.may_be_missed - 1].degrees;
  const double share = share_that_may_rise(run, degrees, 0);
  return share > 0 && share <= run.strategy.claimed->goal->few_miss;
}

/// With a surface that may change: the targets from the first one on that so many cells miss that it was left
/// out, or up to `claimed` degrees so many that the mesh is poor. None where there is no such, or beyond that
/// a few cells are what keeps the worst angle down.
std::span<const TargetAngle> left_out(const Run& run, double claimed) {
  const std::span<const TargetAngle> targets = run.strategy.targets.targets;
  std::vector<double> angles;
  for (const TargetAngle& target : targets) angles.push_back(target.degrees);
  const AngleTally tally = run.tally_below(angles);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const bool is_claimed = angles[k] <= claimed;
    const double many = is_claimed ? run.strategy.throughout.share : targets[k].largest_share;
    if (!(tally.share(k) > many) || !(tally.share(k, n_at_ceiling(run, angles[k])) > many)) continue;
    if (!is_claimed && few_are_far_below(run, k)) break;
    return targets.subspan(k);
  }
  return {};
}

/// Where many cells miss what is claimed: those that others, which nothing raises, have kept from their turn.
/// Goes on, with more cells, while more than a few of those below an angle up to that are mended, or the
/// number of cells is in the way. With a surface that may change all targets from the first one on that was
/// left out, for many cells miss it; once where that is beyond what is claimed, or where cells stay inverted
/// or flat: more often takes as long as all else.
void raise_others(const Run& run) {
  if (!run.strategy.claimed || run.control.stopped()) return;
  const Strategy& claimed = *run.strategy.claimed;
  const GoalEffort& goal = *claimed.goal;
  const double many = claimed.throughout.share;
  std::span<const TargetAngle> targets;
  if (run.surface)
    targets = left_out(run, goal.degrees);
  else if (share_that_may_rise(run, goal.degrees, many) > many)
    targets = claimed.targets.targets;
  if (targets.empty()) return;
  const bool many_miss = targets.front().degrees <= goal.degrees;  // what is claimed
  std::vector<double> angles, claimed_angles;
  for (const TargetAngle& target : targets) {
    angles.push_back(target.degrees);
    if (target.degrees <= goal.degrees) claimed_angles.push_back(target.degrees);
  }
  Run part = run.within(claimed.bounds);
  const bool is_once = !many_miss || (run.surface && run.survey().n_invalid > 0);
  const bool may_grow = !is_once && part.bounds.max > 0 && claimed.bounds_asked.max == 0;
  const Findings found = run.findings;
  const Revision usual = run.control.revision();
  Trial trial(run, angles);
  Best best(run, goal.may_fall, Loss::kMadeUpFor);
  for (int turn = 0; turn < goal.turns && !run.control.stopped(); ++turn) {
    if (turn > 0)
      part.bounds.max = static_cast<std::size_t>(goal.more_cells * static_cast<double>(part.bounds.max));
    if (may_grow && turn + 1 < goal.turns && !part.has_room()) continue;
    std::vector<std::size_t> before;
    if (may_grow) before = n_that_may_rise(run, claimed_angles);
    run.findings.forget_cell_bound();
    raise_to_targets(part, targets, many_miss ? WhenManyMiss::kPastVain : WhenManyMiss::kWhileItRises);
    best.note();
    if (!may_grow) break;
    const std::vector<std::size_t> now = n_that_may_rise(run, claimed_angles);
    const bool has_mended_some = !std::ranges::equal(now, before, [](std::size_t left, std::size_t n) {
      return static_cast<double>(left) >= (1 - kFewShare) * static_cast<double>(n);
    });
    const bool are_left = std::ranges::any_of(now, [](std::size_t n) { return n > 0; });
    if (!are_left || (!has_mended_some && !run.findings.met_cell_bound)) break;
  }
  best.settle();
  trial.settle();
  if (run.control.revision() == usual) run.findings = found;
}

bool run_towards_goal(const Run& run, const GoalEffort& goal) {
  mend_invalid(run);
  if (goal.polish_only) return polish(run, run.strategy.polish, goal.degrees);
  if (share_that_may_rise(run, goal.degrees, goal.many_miss) <= goal.many_miss) {
    if (reach_goal(run, goal, /*cells_are_untouched=*/true)) return true;
  } else {
    Trial trial(run, goal.degrees);
    improve_all(run, run.strategy.floor, run.strategy.targets.targets);
    if (reach_goal(run, goal, /*cells_are_untouched=*/false)) return true;
    trial.settle();
  }
  reach_claimed(run, run.findings.ever_met_cell_bound);
  return run.n_below(goal.degrees) == 0;
}

void mend_and_improve_all(const Run& run) {
  mend_invalid(run);
  improve_all(run, run.strategy.floor, run.strategy.targets.targets);
}

/// Where a run stands: what begins from there again has the same bits.
struct Beginning {
  Snapshot mesh;
  std::uint32_t clock;
  bool is_input = false;  // with cells that what every run does first did not make valid; see make_valid()

  explicit Beginning(const Run& run) : mesh(run), clock(run.work.clock) {}
  void put_back(const Run& run) {
    run.work.clock = clock;
    mesh.put_back(run);
  }
};

/// Where the worst angle that is claimed was not reached and the mesh is poor throughout all the same: the
/// run that is asked for it, from the beginning, for there the order decides what the worst cells come to. If
/// that reaches more, all cells are improved from there, and of all that the best mesh is kept. Where only
/// a few cells are poor by then, more of them on promise instead.
void run_towards_claim(const Run& run, Beginning from, std::optional<Best::Beginning> claiming) {
  const Strategy& strategy = *run.strategy.towards_claim;
  const double before = smallest_that_may_rise(run, strategy.goal->degrees);
  if (before >= strategy.goal->degrees || run.control.stopped()) return;
  if (!is_poor_throughout(run)) {
    reach_claimed(run, run.findings.ever_met_cell_bound, /*on_promise=*/true, std::move(claiming));
    return;
  }
  Best best(run, strategy.goal->may_fall, Loss::kMadeUpFor);
  const Revision usual = run.control.revision();
  from.put_back(run);
  const Findings found = std::exchange(
      run.findings, {.is_folded = run.findings.is_folded, .may_cover_twice = run.findings.may_cover_twice});
  const Run part = run.with(strategy);
  if (!run_towards_goal(part, *strategy.goal)) raise_others(part);
  if (smallest_that_may_rise(run, strategy.goal->degrees) > before + kLeastRise) {
    best.note();
    CellBounds bounds = run.bounds;
    if (bounds.max > 0) bounds.max = std::max(bounds.max, run.n_cells());
    improve_all(run.within(bounds), run.smallest_dihedral(), run.strategy.targets.targets);
  }
  best.settle();
  if (run.control.revision() == usual) run.findings = found;
}

/// With a frozen surface. A mesh that is poor throughout is kept as it came in until the end.
void run_default(const Run& run) {
  std::optional<Beginning> beginning;
  if (run.strategy.towards_claim && is_poor_throughout(run)) beginning.emplace(run);
  mend_and_improve_all(run);
  auto claiming = reach_claimed(run, run.findings.met_cell_bound, /*on_promise=*/!beginning);
  if (beginning) run_towards_claim(run, std::move(*beginning), std::move(claiming));
  raise_others(run);
}

Run with_frozen_surface(const Run& run) {
  Run part = run.with(*run.strategy.frozen);
  part.surface = nullptr;
  return part;
}

/// Whether a run with the surface frozen may mend what is below what it claims.
bool frozen_may_help(const Run& run) {
  return run.strategy.frozen && !run.control.stopped() &&
         may_rise(with_frozen_surface(run), run.strategy.frozen->claimed->goal->degrees);
}

/// What every run does first where cells are inverted or flat: once without holding each cluster to being no
/// more damaged, and held where that leaves some so; the better of both. A run that is to keep more of the
/// surface may mend others from the input, which is returned if cells stay invalid and there is such a run.
std::optional<Beginning> make_valid(const Run& run) {
  if (!run.strategy.plain) return {};
  const Strategy& plain = *run.strategy.plain;
  const auto mend = [&] {
    const bool is_valid = run_towards_goal(run.with(plain), *plain.goal) || run.survey().n_invalid == 0;
    run.keep(is_valid);
    return is_valid;
  };
  Beginning input(run);
  if (mend()) return {};
  if (!run.work.holds_damage && !run.control.stopped()) {
    const auto is_allowed = [&] { return !run.checkpoint || run.checkpoint->allows(run.mesh); };
    const Standing found = run.standing();
    const bool was_allowed = is_allowed();
    Beginning unheld(run), again = input;
    again.put_back(run);
    run.work.holds_damage = true;
    const bool is_valid = mend();
    run.work.holds_damage = false;
    if (is_valid) return {};
    // What is worse than the input in anything would not be given back.
    if (!is_better(run.standing(), found) || (was_allowed && !is_allowed())) unheld.put_back(run);
  }
  const auto keeps_more = [](const Strategy& s) { return s.frozen || s.without_goal; };
  if (!keeps_more(run.strategy) && !(run.strategy.usual && keeps_more(*run.strategy.usual))) return {};
  input.is_input = true;
  return input;
}

/// The run with the surface frozen: goes on from there, or begins at `from`, and keeps the better of what
/// there was and what comes.
void run_frozen(const Run& run, std::optional<Beginning> from = {}) {
  const Strategy& frozen = *run.strategy.frozen;
  Best best(run, frozen.claimed->goal->may_fall, Loss::kMadeUpFor);
  if (from) from->put_back(run);
  const Run part = with_frozen_surface(run);
  if (from && from->is_input) make_valid(part);
  run_default(part);
  best.settle();
}

void run_usual(const Run& run, std::optional<Beginning> input = {});

/// The run with a flat surface, from the beginning, and the better of what there was and what comes: a free
/// run may do all that this one may.
void run_flat(const Run& run, Beginning from) {
  if (run.control.stopped() || !may_rise(run, run.strategy.claimed->goal->degrees)) return;
  const Strategy& strategy = *run.strategy.flat;
  Best best(run, strategy.claimed->goal->may_fall, Loss::kMadeUpFor);
  from.put_back(run);
  const FlatSurface surface(run);
  Run part = run.with(strategy);
  part.surface = surface.get();
  run_usual(part, from.is_input ? make_valid(part) : std::nullopt);
  rebuild_surface(run);
  best.settle();
}

/// A default run, whatever the surface may do. `input`: see make_valid().
void run_usual(const Run& run, std::optional<Beginning> input) {
  if (!run.strategy.frozen) return run_default(run);
  const bool lacks = lacks_vertices(run);
  std::optional<Beginning> beginning;
  if (lacks || run.strategy.flat) beginning.emplace(run);
  mend_and_improve_all(run);
  const bool is_poor = frozen_may_help(run);
  reach_claimed(run, run.findings.met_cell_bound);
  if (is_poor) run_frozen(run);
  if (input && run.survey().n_invalid > 0) beginning = std::move(input);
  if (run.strategy.flat)  // which may go on with a frozen one
    run_flat(run, std::move(*beginning));
  else if (beginning && frozen_may_help(run))
    run_frozen(run, std::move(beginning));
  raise_others(run);
}

/// Where a goal was missed, the run without one from the beginning, and of both the one that comes closer: a
/// goal asks for nothing but the worst angle.
void run_without_goal(const Run& run, const GoalEffort& goal, Beginning from,
                      std::optional<Beginning> input) {
  if (run.control.stopped() || !may_rise(run, run.strategy.claimed->goal->degrees)) return;
  constexpr double kAll = 1;
  Best best(run, kAll);
  from.put_back(run);
  run_usual(run.with(*run.strategy.without_goal), std::move(input));
  best.note();
  polish(run, run.strategy.polish, goal.degrees);
  best.settle();
}

/// A run towards a goal, whatever the surface may do.
bool run_to_goal(const Run& run, const GoalEffort& goal, std::optional<Beginning> input) {
  std::optional<Beginning> beginning;
  if (run.strategy.without_goal) beginning.emplace(run);
  if (run_towards_goal(run, goal)) return true;
  raise_others(run);
  // That goes on with a frozen surface, too.
  if (beginning) run_without_goal(run, goal, std::move(*beginning), std::move(input));
  return run.n_below(goal.degrees) == 0;
}

bool run_at_any_cost(const Run& run, const AnyCostEffort& effort, std::optional<Beginning> input) {
  const Run usual = run.strategy.usual ? run.with(*run.strategy.usual) : run;
  run_usual(usual, std::move(input));
  Best best(run, effort.may_fall);
  raise_at_any_cost(run, effort, best);
  best.settle();
  return false;
}

}  // namespace

void improve_all(const Run& run, double floor, std::span<const TargetAngle> targets) {
  const Strategy& strategy = run.strategy;
  const FirstPolish& first = strategy.first_polish;
  polish(run, first.polish, first.target, {.largest_share = first.largest_share});
  if (strategy.coarsen) coarsen(run, *strategy.coarsen);
  improve_bulk(run, strategy.bulk);
  run.control.set_fraction(kBulkDone);
  // The worst angle rises in no case while a cell stays inverted or flat, so that vertices which are put in
  // for a target have to show in the cells below it.
  std::optional<Trial> trial;
  if (!targets.empty() && run.survey().n_invalid > 0) trial.emplace(run, targets.front().degrees);
  raise_worst_angles(run, floor, targets);
  if (trial) trial->settle();
}

bool run_stages(const Run& run) {
  std::optional<Beginning> input = make_valid(run);
  switch (run.strategy.course) {
    case Course::kDefault:
      run_usual(run, std::move(input));
      return false;
    case Course::kGoal:
      return run_to_goal(run, *run.strategy.goal, std::move(input));
    case Course::kAnyCost:
      return run_at_any_cost(run, *run.strategy.any_cost, std::move(input));
    case Course::kCompat:
      run_jpdc2013(run, run.strategy.compat);
  }
  return false;
}

}  // namespace hfr
