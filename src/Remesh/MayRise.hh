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
/// Cells of the whole below `degrees` that say nothing of the others there: at their ceiling, or below
/// `vain_below` degrees, for which work has been in vain.
std::size_t n_out_of(const Run& run, double degrees, double vain_below = 0);
/// The other cells below `degrees`, ascending; of a mesh in parts those that this one answers for.
std::vector<CellHandle> cells_that_may_rise(const Run& run, double degrees);
/// Smallest dihedral of these, in degrees; `degrees` where there is none.
double smallest_that_may_rise(const Run& run, double degrees);
/// The share of the cells that are below and may rise, where that of all is larger than `largest`; else that
/// of all, which is cheaper and decides as well whether there are too many.
double share_that_may_rise(const Run& run, double degrees, double largest);
/// At most `degrees`, such that no more than n cells of the whole that may rise are below.
double degrees_with_few_that_may_rise(const Run& run, double degrees, std::size_t n);

}  // namespace hfr

#endif
