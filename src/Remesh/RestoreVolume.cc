// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/RestoreVolume.hh"

#include "Remesh/PassRunner.hh"

namespace hfr {

void restore_volume(const Run& run, const VolumeEffort& effort) {
  if (!run.surface) return;
  if (effort.keeps_angles_only)
    PassRunner<MinDihedral>(run, MinDihedral{}, "volume").restore_volume(effort);
  else
    PassRunner<MinSine2>(run, MinSine2{}, "volume").restore_volume(effort);
}

}  // namespace hfr
