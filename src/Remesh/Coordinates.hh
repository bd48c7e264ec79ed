// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_COORDINATES_HH
#define HFR_REMESH_COORDINATES_HH

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"
#include "Surface/TriangleMesh.hh"

namespace hfr {

/// Throws InvalidInput, with a line that says what to do, where no decision could be relied on:
///  - a coordinate beyond 1e30, or a bounding box (not a single point) whose longest side is below 1e-25:
///    products of lengths would leave the range of doubles;
///  - most cells have no edge as long as 64 times the distance of doubles at the largest coordinate: their
///    angles are then those of the rounding, and what moves in a plane leaves it by as much.
/// A pass over the points; another over the cells only where the mesh is far from the origin for its size.
void require_sound_coordinates(const TetMesh& mesh, par::Policy policy);
/// The same for triangles, whose vertices exist.
void require_sound_coordinates(const TriangleMesh& mesh);

}  // namespace hfr

#endif
