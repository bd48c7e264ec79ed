// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_JPDC2013_HH
#define HFR_REMESH_JPDC2013_HH

#include "Remesh/Run.hh"

namespace hfr {

/// The paper's pipeline in the paper's form: star operators and candidate smoothing over the whole mesh, edge
/// → face → node → smooth, a fixed number of iterations.
void run_jpdc2013(const Run& run, const CompatEffort& effort);

}  // namespace hfr

#endif
