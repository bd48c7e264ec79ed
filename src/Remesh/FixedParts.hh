// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_FIXED_PARTS_HH
#define HFR_REMESH_FIXED_PARTS_HH

#include "HalfFace/TetMesh.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {

/// Throws InvalidInput that names the first of options.fixed_… that the mesh does not have: one that is
/// misspelt would hold nothing, and nobody would know. O(star) for each edge and face.
void require_fixed_parts(const TetMesh& mesh, const SurfaceOptions& options);

}  // namespace hfr

#endif
