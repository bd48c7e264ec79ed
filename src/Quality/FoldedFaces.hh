// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_FOLDED_FACES_HH
#define HFR_QUALITY_FOLDED_FACES_HH

#include <functional>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Parallel/Parallel.hh"

namespace hfr {

/// Boundary faces that lie on or go through another one with which they share a vertex or an edge, ascending.
/// That alone proves nothing of the cells: the faces may be the two sides of a slit, and a boundary that goes
/// through itself may be filled by positive cells. See unfillable_faces(). Faces that meet without sharing a
/// vertex are not looked for. `at`: only those that do so at a vertex with at(vertex); all where it is empty.
std::vector<HalfFaceHandle> folded_faces(const TetMesh& mesh, par::Policy policy = {},
                                         const std::function<bool(VertexHandle)>& at = {});

/// Whether a boundary face at one of these vertices lies on or goes through another one there.
bool is_folded_at(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy = {});

}  // namespace hfr

#endif
