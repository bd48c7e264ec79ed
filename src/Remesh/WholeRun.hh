// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_WHOLE_RUN_HH
#define HFR_REMESH_WHOLE_RUN_HH

#include "Remesh/Run.hh"

namespace hfr {

/// How a run has ended.
struct Ending {
  bool meets = false;  ///< every cell is known to meet the goal
  bool stays = false;  ///< what the stages have made; otherwise what the checkpoint kept
};
/// All stages, and what sees to it that they leave the mesh no worse than the input. Expects a checkpoint.
Ending run_to_the_end(const Run& run);

}  // namespace hfr

#endif
