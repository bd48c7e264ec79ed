// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_COORDINATES_HH
#define HFR_REMESH_COORDINATES_HH

#include <cstddef>
#include <functional>

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

// What these ask, for a mesh that lies in parts.

/// Bounds of coordinates; one that is no number stays in them.
struct CoordinateBox {
  Vec3 low, high;
};
/// Of the vertices that have cells; without any, infinity to minus infinity.
CoordinateBox coordinate_box(const TetMesh& mesh, par::Policy policy);
/// Round both.
CoordinateBox joined(CoordinateBox a, const CoordinateBox& b);
/// Of a mesh of n_cells, at least one. n_shorter(least): how many of them have a longest_edge() below that.
void require_sound_coordinates(const CoordinateBox& box, std::size_t n_cells,
                               const std::function<std::size_t(double least)>& n_shorter);
double longest_edge(const TetMesh& mesh, CellHandle c);

}  // namespace hfr

#endif
