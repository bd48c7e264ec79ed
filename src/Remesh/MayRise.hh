// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MAY_RISE_HH
#define HFR_REMESH_MAY_RISE_HH

#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Run.hh"

namespace hfr {

// One cell that what may not change of the surface holds where it is says nothing of the others: effort that
// goes by the worst angle goes by the worst one that may rise.

/// Cells below `degrees` that are proven to have the angle that no mesh exceeds there, as far as it shows in
/// a table; ascending. See StuckCell::ceiling. Of a mesh in parts those that this one answers for.
std::vector<CellHandle> cells_at_ceiling(const Run& run, double degrees);
/// Their number in the whole.
std::size_t n_at_ceiling(const Run& run, double degrees);
/// Smallest dihedral of the others, in degrees; `degrees` where it is no less.
double smallest_that_may_rise(const Run& run, double degrees);

}  // namespace hfr

#endif
