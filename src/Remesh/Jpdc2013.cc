// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, A CPU-GPU framework for optimizing the quality of large meshes, JPDC 73 (2013): DYNAMIC
// IMPROVE MESH with its star-form operators, for tables that compare like with like.
#include "Remesh/Jpdc2013.hh"

#include "Remesh/PassRunner.hh"

namespace hfr {

void run_jpdc2013(const Run& run, const CompatEffort& effort) {
  PassRunner<VolumeLength> runner(run, VolumeLength{}, "jpdc2013");
  for (int i = 1; i <= effort.iterations && !run.control.stopped(); ++i) {
    runner.look_again();  // the paper visits every element in every iteration
    std::size_t changes = 0;
    for (PassKind kind : {PassKind::kEdge, PassKind::kFace, PassKind::kNode})
      changes += runner.star_pass(kind, i);
    changes += runner.pass(PassKind::kSmooth, {.iteration = i});
    if (changes == 0) break;
  }
  runner.to_host();
}

}  // namespace hfr
