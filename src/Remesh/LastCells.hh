// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_LAST_CELLS_HH
#define HFR_REMESH_LAST_CELLS_HH

#include <span>

#include "Remesh/Run.hh"

namespace hfr {

/// Mends the last few cells below the first target that is missed, and those below the next ones. True when
/// the worst angle has risen.
/// Expects: a mesh in which raise_to_targets() has done what it can. Guarantees: the smallest sine of the
/// dihedral angles does not fall. Ends: with the first target that is missed or that too many cells miss, or
/// with the run.
bool improve_last_cells(const Run& run, const LastCellsEffort& effort, std::span<const TargetAngle> targets);

}  // namespace hfr

#endif
