// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Refine.hh"

#include <algorithm>

#include "Quality/Metrics.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/PassRunner.hh"
#include "Remesh/Trial.hh"

namespace hfr {

void insert_where_poor(const Run& run, const RefineEffort& effort) {
  PassRunner<MinSine2> runner(run, MinSine2{}, "refine");
  const Focus focus{dihedral_decision(effort.below)};
  std::size_t n_poor = runner.n_below(focus.below);
  for (int i = 1; i <= effort.iterations && n_poor > 0 && !run.control.stopped(); ++i) {
    const Turn turn{i, focus, /*removes_vertices=*/false, effort.seeds_of_vertex};
    runner.iterate(turn);
    const std::size_t n_left = runner.n_below(focus.below);
    const bool helps = static_cast<double>(n_left) < effort.fewer * static_cast<double>(n_poor);
    n_poor = n_left;
    if (!helps && runner.insert(turn, effort.gain) * effort.one_in <= n_poor) break;
  }
  runner.to_host();
}

bool refine(const Run& run, const RefineEffort& effort) {
  if (run.control.stopped() || run.smallest_dihedral() >= effort.below) return false;
  const double share = share_that_may_rise(run, effort.below, effort.least_share);
  if (share <= effort.least_share || share >= effort.largest_share) return false;
  const bool met_before = run.findings.met_cell_bound;
  CellBounds bounds = run.bounds;
  bounds.max = bounds.max > 0
                   ? std::max<std::size_t>(bounds.max * effort.of_hundred / 100, 1)
                   : static_cast<std::size_t>(effort.more_cells * static_cast<double>(run.n_cells()));
  const Run part = run.within(bounds);
  Trial trial(part, effort.below);
  insert_where_poor(part, effort);
  trial.settle();
  if (!met_before) run.findings.forget_cell_bound();
  return true;
}

}  // namespace hfr
