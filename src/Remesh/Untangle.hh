// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_UNTANGLE_HH
#define HFR_REMESH_UNTANGLE_HH

#include "Remesh/Run.hh"

namespace hfr {

/// Mends inverted and flat cells: vertices are moved first, then the surroundings of the damage reconnected
/// in the metric Untangling, wider and wider while that helps.
/// Expects: any mesh. Guarantees: never more inverted cells, nor more inverted and flat ones together; the
/// worst angle may fall (Run::keep() is called before). Ends: when none is left, when neither moving nor
/// reconnecting has helped, or with the run. True when none is known to be left.
bool untangle(const Run& run, const UntangleEffort& effort);

}  // namespace hfr

#endif
