// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_COVERAGE_HH
#define HFR_QUALITY_COVERAGE_HH

#include <functional>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Parallel/Parallel.hh"

namespace hfr {

/// Whether the cells round some vertex cover a direction twice: then they lie over one another, although all
/// are positive and no face of the boundary lies on another. So it is where the cells round an inner edge
/// make more than one turn, or those round an edge of the boundary one; inverted cells that come right may
/// leave it so. For meshes of positive cells without folded_faces(); true where a cell is not positive. `at`:
/// only round vertices with at(vertex), all of whose cells the mesh must have; all where it is empty.
bool covers_twice(const TetMesh& mesh, par::Policy policy = {},
                  const std::function<bool(VertexHandle)>& at = {});

}  // namespace hfr

#endif
