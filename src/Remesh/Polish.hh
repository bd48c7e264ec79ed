// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_POLISH_HH
#define HFR_REMESH_POLISH_HH

#include "Remesh/PassRunner.hh"
#include "Remesh/Run.hh"

namespace hfr {

/// How many cells there may be below an angle for it to be worked for, and which do not count among them.
struct PoorOnes {
  double largest_share = 1;  ///< of the cells of the mesh
  double vain_below = 0;     ///< degrees; see n_out_of()
};

/// Works on cells with a dihedral below `degrees`, or above 180 degrees minus that, and then on the former
/// alone. True when the smallest dihedral meets it.
/// Expects: any mesh. Guarantees: the smallest sine of the dihedral angles, then the smallest dihedral does
/// not fall. Ends: when no cell is below, when nothing helps, or with the run; at once where a larger share
/// is below than may be.
bool polish(const Run& run, const PolishEffort& effort, double degrees, const PoorOnes& poor = {});
/// The same towards a decision value of MinDihedral, which may be that of an inverted cell.
bool polish_to(const Run& run, const PolishEffort& effort, double decision, const PoorOnes& poor = {});

/// Iterates on cells below a decision value while that helps. Where they are no more than `few`, each is
/// worth what is dear: a new vertex, then a search of all clusters round it. `n_held`: of the cells below
/// when it begins, that do not count among these. True when there are none any more. For MinSine2 and
/// MinDihedral.
template <class Metric>
bool iterate_below(PassRunner<Metric>& runner, const PolishEffort& effort, double decision, std::size_t few,
                   std::size_t n_held);

}  // namespace hfr

#endif
