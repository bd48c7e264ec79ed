// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_OPTIONS_HH
#define HFR_SURFACE_SURFACE_OPTIONS_HH

#include <array>
#include <optional>
#include <vector>

#include "hfremesh/HalfFace/Handles.hh"

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
  /// Largest distance from the input surface and of it from the result, in the mesh's units; folded plane
  /// walls of the input count as they are once opened (docs/surface.md, "Folds"). Default: three tenths of
  /// the mean edge length of the surface, but no more than 0.005 of the diagonal of its bounding box. 0: only
  /// coplanar changes, as in flat mode.
  std::optional<double> hausdorff;
  /// Degrees that a new triangle may be turned against the input beneath it.
  double normal_angle = 50;
  /// Pairs of patches that match by a translation: their vertices move together, by the same step, or not at
  /// all, and their faces stay the same ones. Checked when the surface is made.
  std::vector<std::array<int, 2>> periodic;
  /// What stays as it is beside what the mesh itself has fixed (TetMesh::set_fixed, set_fixed_patch).
  std::vector<int> fixed_patches;
  std::vector<VertexHandle> fixed_vertices;
  std::vector<std::array<VertexHandle, 2>> fixed_edges;
  std::vector<std::array<VertexHandle, 3>> fixed_faces;
};

}  // namespace hfr

#endif
