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

/// Whether vertices put in for many cells come to an end: not in runs with a surface that may change, and of
/// goals that have met their own bound on cells.
bool is_bounded(const Run& run) { return !run.surface && run.bounds.max > 0; }

/// `below`: the share of cells below ThroughoutEffort::below.
bool is_poor_throughout(const Run& run, double below) {
  return lacks_vertices(run) || below > run.strategy.throughout.share;
}

/// One target of a mesh that is poor throughout. The rest of the bound on cells is for the last ones.
void raise_throughout(const Run& run, const ThroughoutEffort& effort, double degrees) {
  CellBounds bounds = run.bounds;
  if (bounds.max > 0) bounds.max = std::max<std::size_t>(bounds.max * effort.of_hundred / 100, 1);
  const Run part = run.within(bounds);
  Trial trial(part, degrees);
  polish(part, effort.polish, degrees);
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
  return is_poor_throughout(run, run.share_below(run.strategy.throughout.below));
}

void raise_to_targets(const Run& run, std::span<const TargetAngle> targets) {
  const TargetEffort& effort = run.strategy.targets;
  const ThroughoutEffort& throughout = run.strategy.throughout;
  std::vector<double> angles;
  for (const TargetAngle& target : targets) angles.push_back(target.degrees);
  angles.push_back(throughout.below);
  AngleTally now = run.tally_below(angles);
  const bool bounded = is_bounded(run),
             is_poor = bounded && is_poor_throughout(run, now.share(targets.size()));
  double last = 0;          // that was worked for
  bool has_brought = true;  // enough, the target before
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const TargetAngle& target = targets[k];
    if (run.control.stopped()) return;
    if (now.smallest >= target.degrees) continue;
    if (target.degrees > effort.in_turn_beyond && now.smallest < last &&
        smallest_that_may_rise(run, last) < last)
      break;
    const double share = now.share(k);
    if (share > target.largest_share && !(has_brought && bounded)) continue;
    last = target.degrees;
    if (share > (is_poor ? throughout.dig_share : target.largest_share))
      raise_throughout(run, throughout, target.degrees);
    else
      polish(run, run.strategy.polish, target.degrees);
    now = run.tally_below(angles);
    has_brought = now.share(k) < effort.enough_left * share;
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
