// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Targets.hh"

#include <algorithm>
#include <vector>

#include "Remesh/LastCells.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/Polish.hh"
#include "Remesh/Refine.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Trial.hh"

namespace hfr {
namespace {

/// Whether vertices put in for many cells come to an end: not of goals that have met their own bound on
/// cells. With a surface that may change they take many times as long as all else, and are for what that
/// leaves.
bool is_bounded(const Run& run, WhenManyMiss when_many_miss = WhenManyMiss::kUsual) {
  return run.bounds.max > 0 && (!run.surface || when_many_miss != WhenManyMiss::kUsual);
}

/// One target of a mesh that is poor throughout. The rest of the bound on cells is for the last ones.
void raise_throughout(const Run& run, const ThroughoutEffort& effort, double degrees, double vain_below) {
  CellBounds bounds = run.bounds;
  if (bounds.max > 0) bounds.max = std::max<std::size_t>(bounds.max * effort.of_hundred / 100, 1);
  const Run part = run.within(bounds);
  Trial trial(part, degrees);
  polish(part, effort.polish, degrees, {.vain_below = vain_below});
  trial.settle();
}

}  // namespace

bool lacks_vertices(const Run& run) {
  const auto here = [&] {
    VertexTally tally;
    for (VertexHandle v : run.mesh.vertices()) {
      ++tally.n;
      tally.n_movable += run.work.frozen[v.idx()] == 0 ? 1 : 0;
    }
    return tally;
  };
  const VertexTally vertices = run.is_part() ? run.parts()->vertices() : here();
  return static_cast<double>(vertices.n_movable) <=
         run.strategy.throughout.share * static_cast<double>(vertices.n);
}

bool is_poor_throughout(const Run& run) {
  const ThroughoutEffort& effort = run.strategy.throughout;
  return lacks_vertices(run) || share_that_may_rise(run, effort.below, effort.share) > effort.share;
}

void raise_to_targets(const Run& run, std::span<const TargetAngle> targets, WhenManyMiss when_many_miss) {
  const TargetEffort& effort = run.strategy.targets;
  const ThroughoutEffort& throughout = run.strategy.throughout;
  std::vector<double> angles;
  for (const TargetAngle& target : targets) angles.push_back(target.degrees);
  AngleTally now = run.tally_below(angles);
  const bool bounded = is_bounded(run, when_many_miss), is_poor = bounded && is_poor_throughout(run);
  const bool goes_on = when_many_miss != WhenManyMiss::kWhileItRises;
  double last = 0;          // that was worked for
  bool has_brought = true;  // enough, the target before
  double vain_below = 0;    // the last target that has mended next to none of its cells
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const TargetAngle& target = targets[k];
    if (run.control.stopped()) return;
    if (now.smallest >= target.degrees) continue;
    if (target.degrees > effort.in_turn_beyond && now.smallest < last &&
        smallest_that_may_rise(run, last) < last)
      break;
    const double many = is_poor ? throughout.dig_share : target.largest_share;
    const std::size_t n_out =
        now.share(k) > many || vain_below > 0 ? n_out_of(run, target.degrees, vain_below) : 0;
    const double share = now.share(k, n_out);
    if (share == 0 || (share > target.largest_share && !(has_brought && bounded))) continue;
    last = target.degrees;
    const double before = goes_on ? 0 : smallest_that_may_rise(run, target.degrees);
    if (share > many)
      raise_throughout(run, throughout, target.degrees, vain_below);
    else
      polish(run, run.strategy.polish, target.degrees, {.vain_below = vain_below});
    now = run.tally_below(angles);
    if (!goes_on &&
        smallest_that_may_rise(run, target.degrees) < std::min(before + kLeastRise, target.degrees))
      return;
    const double left = now.share(k, n_out);
    has_brought = left < effort.enough_left * share;
    if (when_many_miss == WhenManyMiss::kPastVain && is_poor && left > (1 - kFewShare) * share) {
      vain_below = target.degrees;
      has_brought = true;
    }
  }
}

void raise_worst_angles(const Run& run, double floor, std::span<const TargetAngle> targets) {
  const Strategy& strategy = run.strategy;
  if (run.smallest_dihedral() < floor) polish(run, strategy.polish, floor);
  const ThroughoutEffort& poor = strategy.throughout;
  // Where the mesh is poor throughout, vertices go to the worst cells first.
  const bool throughout = is_bounded(run) && is_poor_throughout(run);
  if (strategy.refine && !throughout) refine(run, *strategy.refine);
  raise_to_targets(run, targets);
  // What was put in first is well connected by now, which shows where vertices are still missing.
  const std::optional<RefineEffort>& again = throughout ? poor.refine : strategy.refine_again;
  if (again && refine(run, *again)) raise_to_targets(run, targets);
  // Whatever raises the last few takes from their neighbours.
  if (improve_last_cells(run, strategy.last_cells, targets)) raise_to_targets(run, targets);
}

}  // namespace hfr
