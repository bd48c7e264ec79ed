// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_BULK_HH
#define HFR_REMESH_BULK_HH

#include "Remesh/Run.hh"

namespace hfr {

/// Improves all cells in one metric.
/// Expects: any mesh. Guarantees: no cluster has a worse cell in that metric; the worst angle may fall. Ends:
/// after so many iterations, with one that changes nothing, or with the run.
void improve_bulk(const Run& run, const BulkEffort& effort);

}  // namespace hfr

#endif
