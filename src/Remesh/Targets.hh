// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_TARGETS_HH
#define HFR_REMESH_TARGETS_HH

#include <span>

#include "Remesh/Run.hh"

namespace hfr {

/// Whether all but a few vertices stay where they are: inner ones are missing, whatever the angles are.
bool lacks_vertices(const Run& run);
/// Whether that is so, or too many of its cells are poor: see ThroughoutEffort.
bool is_poor_throughout(const Run& run);
/// What becomes of a target that many cells miss. It is worked for only if the one before has brought enough.
enum class WhenManyMiss {
  kUsual,         ///< left out with a surface that may change
  kWhileItRises,  ///< not left out; and no target is tried after one that has not raised the worst angle
  /// Not left out; and one that has mended next to none of its cells is no reason to leave the next: whatever
  /// holds these cells, they say nothing of others, and do not count among those that miss it.
  kPastVain,
};
/// Raises the worst angles from target to target; one that is missed is no reason to stop, because what holds
/// a cell below it may give way on the next.
///
/// Expects: any mesh. Guarantees: what polish() does. Ends: after the last target, or with the run.
void raise_to_targets(const Run& run, std::span<const TargetAngle> targets,
                      WhenManyMiss when_many_miss = WhenManyMiss::kUsual);
/// Raises the worst angles as far as a limited effort takes them: back to `floor` degrees, where they stood
/// before the bulk stage, then vertices where they are missing, the targets, and the last few cells.
void raise_worst_angles(const Run& run, double floor, std::span<const TargetAngle> targets);

}  // namespace hfr

#endif
