// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Neighbourhoods.hh"

#include <algorithm>
#include <vector>

#include "HalfFace/Layers.hh"
#include "Quality/Metrics.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/Polish.hh"

namespace hfr {

void improve_neighbourhoods(const Run& run, const std::optional<NeighbourhoodEffort>& effort,
                            double degrees) {
  if (!effort) return;
  const double decision = dihedral_decision(degrees);
  for (const NeighbourhoodEffort::Try& attempt : effort->tries) {
    const std::vector<CellHandle> left = cells_that_may_rise(run, degrees);
    const std::size_t n_left = run.is_part() ? run.parts()->sum(left.size()) : left.size();
    if (n_left == 0 || n_left > effort->few || run.control.stopped()) return;
    const std::size_t n_held = run.n_below(degrees) - n_left;
    std::vector<std::uint8_t> around;
    if (run.is_part())
      run.parts()->mark_round(left, attempt.layers);
    else
      around = vertices_within(run.mesh, left, attempt.layers);
    PassRunner<MinSine2> runner(run, MinSine2{}, "neighbourhoods");
    const Focus focus{dihedral_decision(std::min(degrees + attempt.degrees, kLargestGoal)), around,
                      run.is_part()};
    for (int i = 1; i <= effort->iterations && !run.control.stopped(); ++i) {
      const Turn turn{i, focus};
      std::size_t changes = runner.iterate(turn);
      changes += runner.pass(PassKind::kFan, turn);
      if (runner.n_below(focus.below) <= effort->few_to_dig) changes += runner.pass(PassKind::kInsert, turn);
      if (changes == 0) break;
    }
    runner.look_again();
    iterate_below(runner, run.strategy.polish, decision, effort->few, n_held);
  }
}

}  // namespace hfr
