// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_ANY_COST_HH
#define HFR_REMESH_ANY_COST_HH

#include "Remesh/Best.hh"
#include "Remesh/Run.hh"

namespace hfr {

/// Raises the worst angle as far as it goes: over all targets again and again while it rises, with the worst
/// cells tried on copies of their surroundings before and after, which may take it beyond targets that were
/// missed, and with vertices put in where they are missing, twice.
/// Expects: what a default run leaves. Guarantees: what polish() does; cells that raise nothing are taken
/// back (Trial), and `best` has seen what each step has left. Ends: when neither targets nor patches have
/// raised the worst angle by AnyCostEffort::again.
void raise_at_any_cost(const Run& run, const AnyCostEffort& effort, Best& best);

}  // namespace hfr

#endif
