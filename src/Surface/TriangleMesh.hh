// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_TRIANGLE_MESH_HH
#define HFR_SURFACE_TRIANGLE_MESH_HH

#include <array>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/Vec3.hh"

namespace hfr {

/// A surface alone, as arrays. It may be open, meet itself in edges and vertices, and contain triangles whose
/// neighbours are ordered the other way round; such edges are features. No triangle may name a vertex twice.
struct TriangleMesh {
  std::vector<Vec3> points;
  std::vector<std::array<VertexHandle, 3>> triangles;
  std::vector<int> patches;  ///< label per triangle, 0 = none; or empty
};

}  // namespace hfr

#endif
