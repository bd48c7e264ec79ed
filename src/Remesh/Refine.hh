// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_REFINE_HH
#define HFR_REMESH_REFINE_HH

#include "Remesh/Run.hh"

namespace hfr {

/// Puts vertices in where the mesh lacks them: where cells are poor and a new vertex raises the worst cell of
/// its cavity by much. Removes none. True when it was begun.
/// Expects: any mesh. Guarantees: the smallest sine of the dihedral angles does not fall; where the new cells
/// raise nothing, all is taken back (Trial). That the bound on cells was met is not noted. Ends: when few of
/// the poor cells get a vertex; at once where the worst angle, or the share of poor cells, shows that none is
/// missing, or with the run.
bool refine(const Run& run, const RefineEffort& effort);
/// The stage itself, within the bounds of the run, without questions and without a way back.
void insert_where_poor(const Run& run, const RefineEffort& effort);

}  // namespace hfr

#endif
