// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_UNFILLABLE_FACES_HH
#define HFR_QUALITY_UNFILLABLE_FACES_HH

#include <span>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Parallel/Parallel.hh"

namespace hfr {

/// Those of `faces`, half-faces of the boundary, at which every mesh inside of this boundary has an inverted
/// or flat cell, in the order given. A proof by winding numbers: next to a point of the face, the boundary
/// goes round fewer times than positive cells behind the faces that lie there would cover the point. It is
/// tried at 16 points of each face, and only where rounding cannot mislead it, so a face that is not returned
/// may still be one. Boundaries that go through themselves but can be filled by positive cells (immersions)
/// have none. Cost: that of sorting the boundary's faces three times, and a few microseconds a face.
std::vector<HalfFaceHandle> unfillable_faces(const TetMesh& mesh, std::span<const HalfFaceHandle> faces,
                                             par::Policy policy = {});
/// The same of the faces in question where the cells `invalid` are left: `folded`, the boundary faces that
/// lie on one another (folded_faces()), and the boundary faces of these cells. Ascending.
std::vector<HalfFaceHandle> unfillable_faces(const TetMesh& mesh, std::span<const CellHandle> invalid,
                                             std::span<const HalfFaceHandle> folded, par::Policy policy = {});

}  // namespace hfr

#endif
