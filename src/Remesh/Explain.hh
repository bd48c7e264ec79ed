// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_EXPLAIN_HH
#define HFR_REMESH_EXPLAIN_HH

#include <cstddef>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Improve.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"

namespace hfr {

/// Fills in which cells are left below the goal, or below the first target that was missed, and what keeps
/// each. Expects result.after, .stop, .passes and .unfillable_faces. `max_cells_met`: the bound on cells that
/// held insertion back; 0: none did. `known`: of the mesh.
void explain(const TetMesh& mesh, const ImproveOptions& options, const Strategy& strategy,
             std::size_t max_cells_met, const KnownValues& known, Result& result);

}  // namespace hfr

#endif
