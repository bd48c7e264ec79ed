// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_COARSEN_HH
#define HFR_REMESH_COARSEN_HH

#include "Remesh/Run.hh"

namespace hfr {

/// Removes vertices where that raises the worst angle of their cells, and works on all cells that are no very
/// good ones.
/// Expects: any mesh. Guarantees: the smallest sine of the dihedral angles does not fall. Ends: when an
/// iteration takes few cells away, or with the run.
void coarsen(const Run& run, const CoarsenEffort& effort);

}  // namespace hfr

#endif
