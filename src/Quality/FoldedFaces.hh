// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_FOLDED_FACES_HH
#define HFR_QUALITY_FOLDED_FACES_HH

#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// Boundary faces that lie on or go through another one with which they share a vertex or an edge, ascending.
/// While the boundary stays as it is, no mesh inside of it is free of inverted and flat cells there, unless
/// the faces are the two sides of a slit. Faces that meet without sharing a vertex are not looked for.
std::vector<HalfFaceHandle> folded_faces(const TetMesh& mesh, par::Policy policy = {});

}  // namespace hfr

#endif
