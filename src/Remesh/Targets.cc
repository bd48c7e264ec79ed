// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Targets.hh"

#include "Remesh/LastCells.hh"
#include "Remesh/Polish.hh"
#include "Remesh/Refine.hh"
#include "Remesh/Survey.hh"

namespace hfr {

void raise_to_targets(const Run& run, std::span<const TargetAngle> targets) {
  double now = smallest_dihedral(run.mesh, run.policy());
  double last = 0;  // that was worked for
  for (const TargetAngle& target : targets) {
    if (run.control.stopped()) return;
    if (now >= target.degrees) continue;
    if (target.degrees > run.strategy.targets.in_turn_beyond && now < last) break;
    last = target.degrees;
    polish(run, run.strategy.polish, target.degrees, target.largest_share);
    now = smallest_dihedral(run.mesh, run.policy());
  }
}

void raise_worst_angles(const Run& run, double floor, std::span<const TargetAngle> targets) {
  const Strategy& strategy = run.strategy;
  if (smallest_dihedral(run.mesh, run.policy()) < floor) polish(run, strategy.polish, floor);
  if (strategy.refine) refine(run, *strategy.refine);
  raise_to_targets(run, targets);
  // What was put in first is well connected by now, which shows where vertices are still missing.
  if (strategy.refine_again && refine(run, *strategy.refine_again)) raise_to_targets(run, targets);
  // Whatever raises the last few takes from their neighbours.
  if (improve_last_cells(run, strategy.last_cells, targets)) raise_to_targets(run, targets);
}

}  // namespace hfr
