// SPDX-License-Identifier: BSD-3-Clause
// Private to src/Remesh: surfaces as lists of triangles, compared.
#ifndef HFR_REMESH_SURFACES_HH
#define HFR_REMESH_SURFACES_HH

#include <array>
#include <vector>

#include "HalfFace/Vec3.hh"
#include "Parallel/Policy.hh"
#include "Remesh/Result.hh"
#include "Surface/TriangleMesh.hh"

namespace hfr {

/// Where a triangle of the mesh has its corners.
inline std::array<Vec3, 3> corners(const TriangleMesh& mesh, const std::array<VertexHandle, 3>& t) {
  return {mesh.points[t[0].idx()], mesh.points[t[1].idx()], mesh.points[t[2].idx()]};
}

/// What closed surfaces enclose, positive when the triangles are seen from outside; right to the last digits.
double enclosed_volume(const std::vector<std::array<Vec3, 3>>& triangles);
/// The part of a report that is measured on the triangles alone.
void measure_surfaces(const std::vector<std::array<Vec3, 3>>& before,
                      const std::vector<std::array<Vec3, 3>>& after, double volume_before,
                      double volume_after, par::Policy policy, SurfaceReport& report);

}  // namespace hfr

#endif
