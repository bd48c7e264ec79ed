// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RESTORE_VOLUME_HH
#define HFR_REMESH_RESTORE_VOLUME_HH

#include "Remesh/Run.hh"

namespace hfr {

/// With a surface that may change its shape: moves it so that the enclosed volume is what it was.
/// Guarantees: no cell gets worse than the worst one is. Ends: when enough of the volume is back, or with a
/// pass that moves nothing.
void restore_volume(const Run& run, const VolumeEffort& effort);

}  // namespace hfr

#endif
