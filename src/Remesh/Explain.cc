// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Explain.hh"

#include <algorithm>
#include <vector>

#include "Remesh/StuckCells.hh"
#include "Remesh/SurfaceRun.hh"

namespace hfr {
namespace {

/// The first target that the worst cells were raised to in vain; 0: none.
double missed_target(const Strategy& strategy, double smallest) {
  const auto& targets = strategy.any_cost ? strategy.any_cost->targets : strategy.targets.targets;
  const auto at = std::find_if(targets.begin(), targets.end(),
                               [&](const TargetAngle& target) { return target.degrees > smallest; });
  return at == targets.end() ? 0.0 : at->degrees;
}

/// What ended the run before it was done; kNotFound where nothing did.
StuckReason ended_by(const ImproveOptions& options, const Result& result) {
  switch (result.stop) {
    case Stop::kTimeLimit:
      return StuckReason::kTimeLimit;
    case Stop::kCancelled:
      return StuckReason::kCancelled;
    case Stop::kDeviceLost:
      return StuckReason::kDeviceLost;
    case Stop::kIterations:
      // Only where the last one that was allowed still changed something.
      return std::any_of(result.passes.begin(), result.passes.end(),
                         [&](const PassReport& pass) {
                           return pass.iteration == options.iterations && pass.winners > 0 &&
                                  (pass.stage == "bulk" || pass.stage == "polish");
                         })
                 ? StuckReason::kIterations
                 : StuckReason::kNotFound;
    case Stop::kGoal:
    case Stop::kNoProgress:
      break;
  }
  return StuckReason::kNotFound;
}

/// The bound on cells that was met, which a stage may have had for itself, and a larger one that was asked
/// for; 0: none. Beyond what a default run claims it keeps to its own, past which that may have taken it.
std::size_t bound_met(const Strategy& strategy, std::size_t n_cells, std::size_t max_cells_met,
                      double smallest) {
  if (max_cells_met > 0) return std::max(max_cells_met, strategy.bounds_asked.max);
  const std::size_t bound = strategy.bounds.max;
  const bool is_beyond =
      strategy.course == Course::kDefault && strategy.claimed && smallest >= strategy.claimed->goal->degrees;
  if (!is_beyond || bound == 0 || n_cells + strategy.pass.cells_of_vertex <= bound) return 0;
  return std::max(bound, n_cells);
}

}  // namespace

void explain(const TetMesh& mesh, const ImproveOptions& options, const Strategy& strategy,
             std::size_t max_cells_met, const KnownValues& known, Result& result) {
  result.stuck_below =
      strategy.goal ? strategy.goal->degrees : missed_target(strategy, result.after.min_dihedral.min);
  if (result.stuck_below == 0) return;
  std::vector<StuckCell>& stuck = result.stuck;
  stuck = stuck_cells(mesh, result.stuck_below, result.unfillable_faces, options.policy, known);
  const bool frozen = options.surface.mode == SurfaceMode::kFrozen;
  if (!frozen) blame_features(mesh, stuck, result.stuck_below, options.surface, options.policy);
  const StuckReason ended = ended_by(options, result);
  for (StuckCell& cell : stuck)
    if (cell.reason == StuckReason::kNotFound) cell.reason = ended;
  const std::size_t bound =
      bound_met(strategy, mesh.n_logical_cells(), max_cells_met, result.after.min_dihedral.min);
  if (bound > 0 && has(options.ops, Ops::kInsert))
    result.cell_bound = blame_max_cells(mesh, stuck, result.stuck_below, bound, options.policy);
  if (frozen) result.held = held_cells(mesh, stuck, result.stuck_below, result.unfillable_faces, options);
}

}  // namespace hfr
