// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_OPTIONS_HH
#define HFR_SURFACE_SURFACE_OPTIONS_HH

#include <array>
#include <optional>
#include <vector>

#include "HalfFace/Handles.hh"

namespace hfr {

/// What a run may do to the boundary and to interfaces between regions.
enum class SurfaceMode {
  kFrozen,  ///< nothing
  kFlat,    ///< new triangulations of planar facets and straight feature edges: the shape stays the same
  kFree,    ///< the shape stays within a distance
};

struct SurfaceOptions {
  SurfaceMode mode = SurfaceMode::kFrozen;
  /// Degrees: an edge at which the surface turns by more is a feature. In flat mode every edge is one at
  /// which it turns at all.
  double feature_angle = 40;
  /// Largest distance from the input surface and of it from the result, in the mesh's units. Default: 0.005
  /// of the surface's diagonal, but a tenth of its mean edge length at least and three tenths at most. 0:
  /// only coplanar changes, as in flat mode.
  std::optional<double> hausdorff;
  /// Degrees that a new triangle may be turned against the input beneath it.
  double normal_angle = 50;
  /// What stays as it is beside what the mesh itself has fixed (TetMesh::set_fixed).
  std::vector<int> fixed_patches;
  std::vector<VertexHandle> fixed_vertices;
  std::vector<std::array<VertexHandle, 2>> fixed_edges;
  std::vector<std::array<VertexHandle, 3>> fixed_faces;
};

}  // namespace hfr

#endif
