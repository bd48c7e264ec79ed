// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_COVERAGE_HH
#define HFR_QUALITY_COVERAGE_HH

#include <functional>
#include <span>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Parallel/Parallel.hh"

namespace hfr {

/// Whether the cells round some vertex cover a direction twice: then they lie over one another, although all
/// are positive and no face of the boundary lies on another. So it is where the cells round an inner edge
/// make more than one turn, or those round an edge of the boundary one; inverted cells that come right may
/// leave it so. True also where a cell is not positive. For meshes without folded_faces(); where the boundary
/// faces of a vertex are more than one closed fan, something may go unseen.
/// `at`: only round vertices with at(vertex), all of whose cells the mesh must have; all where it is empty.
bool covers_twice(const TetMesh& mesh, par::Policy policy = {},
                  const std::function<bool(VertexHandle)>& at = {});

/// Whether the cells round an edge of the boundary at one of these vertices make more than a turn. Of a
/// vertex whose cells do not connect through faces, some are not looked at.
bool is_wound_at(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy = {});

}  // namespace hfr

#endif
