// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_POLISH_HH
#define HFR_REMESH_POLISH_HH

#include "Remesh/PassRunner.hh"
#include "Remesh/Run.hh"

namespace hfr {

/// Works on cells with a dihedral below `degrees`, or above 180 degrees minus that, and then on the former
/// alone. True when the smallest dihedral meets it.
/// Expects: any mesh. Guarantees: the smallest sine of the dihedral angles, then the smallest dihedral does
/// not fall. Ends: when no cell is below, when nothing helps, or with the run; at once where more than
/// `largest_share` of the cells are below.
bool polish(const Run& run, const PolishEffort& effort, double degrees, double largest_share = 1);
/// The same towards a decision value of MinDihedral, which may be that of an inverted cell.
bool polish_to(const Run& run, const PolishEffort& effort, double decision, double largest_share = 1);

/// Iterates on cells below a decision value while that helps. Where they are no more than `few`, each is
/// worth what is dear: a new vertex, then a search of all clusters round it. True when there are none any
/// more. For MinSine2 and MinDihedral.
template <class Metric>
bool iterate_below(PassRunner<Metric>& runner, const PolishEffort& effort, double decision, std::size_t few);

}  // namespace hfr

#endif
