// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_NEIGHBOURHOODS_HH
#define HFR_REMESH_NEIGHBOURHOODS_HH

#include "Remesh/Run.hh"

namespace hfr {

/// Works on the surroundings of the cells below `degrees` as if the angle were larger, and then on these
/// cells again. Does nothing where `effort` is empty. Expects: no more than
/// NeighbourhoodEffort::few cells below; where there are more, it does nothing. Guarantees: the smallest sine
/// of the dihedral angles does not fall. Ends: after all its tries, when no cell is below, or with the run.
void improve_neighbourhoods(const Run& run, const std::optional<NeighbourhoodEffort>& effort, double degrees);

}  // namespace hfr

#endif
