// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PIPELINE_HH
#define HFR_REMESH_PIPELINE_HH

#include <span>

#include "Remesh/Run.hh"

namespace hfr {

/// The stages of a run in their order, as its strategy has it; docs/pipeline.md has the same order. True when
/// every cell is known to meet the goal.
bool run_stages(const Run& run);

/// What a run does of itself once nothing is invalid that can be mended: the worst angles, all cells, then
/// the worst angles up to the targets. `floor`: degrees where these stood before; see raise_worst_angles().
void improve_all(const Run& run, double floor, std::span<const TargetAngle> targets);

}  // namespace hfr

#endif
