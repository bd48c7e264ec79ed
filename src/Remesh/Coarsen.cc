// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Coarsen.hh"

#include "Quality/Metrics.hh"
#include "Remesh/PassRunner.hh"
#include "Remesh/Survey.hh"

namespace hfr {

void coarsen(const Run& run, const CoarsenEffort& effort) {
  PassRunner<MinSine2> runner(run, MinSine2{}, "coarsen");
  const Focus focus{dihedral_decision(effort.below)};
  for (int i = 1; i <= effort.iterations && !run.control.stopped(); ++i) {
    const auto n_before = static_cast<double>(run.n_cells());
    if (runner.iterate({i, focus}) == 0) break;
    if (static_cast<double>(run.n_cells()) > effort.still * n_before) break;
  }
  runner.to_host();
}

}  // namespace hfr
