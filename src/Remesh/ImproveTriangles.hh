// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_IMPROVE_TRIANGLES_HH
#define HFR_REMESH_IMPROVE_TRIANGLES_HH

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "hfremesh/Parallel/Parallel.hh"
#include "hfremesh/Quality/Statistics.hh"
#include "hfremesh/Remesh/Improve.hh"
#include "hfremesh/Surface/SurfaceOptions.hh"
#include "hfremesh/Surface/TriangleMesh.hh"

namespace hfr {

/// A mesh of triangles at one glance. Angles in degrees.
struct TriangleStatistics {
  std::size_t vertices = 0;  ///< that a triangle uses
  std::size_t triangles = 0;
  std::size_t open_edges = 0;          ///< of one triangle
  std::size_t non_manifold_edges = 0;  ///< of more than two, or of two that are ordered against each other
  std::size_t flat = 0;                ///< triangles without area
  Distribution min_angle;              ///< of each triangle's smallest angle
  double max_angle = 0;
  double area = 0;
  double volume = 0;  ///< enclosed, positive when the triangles are seen from outside; 0 for an open surface
};
TriangleStatistics statistics(const TriangleMesh& mesh);

struct TriangleOptions {
  /// `mode` must be kFlat or kFree.
  SurfaceOptions surface;
  /// Goal for the smallest angle, degrees, in (0, 60). With a goal, only triangles that miss it are worked
  /// on.
  std::optional<double> min_angle;
  double time_limit = std::numeric_limits<double>::infinity();  ///< seconds
  par::Policy policy = par::Policy::all();  ///< for measuring the result; the work itself is serial
  std::function<bool()> cancel;             ///< asked between passes
};

struct TriangleResult {
  bool changed = false;
  bool goal_reached = false;  ///< min_angle met where given, and no flat triangle
  Stop stop = Stop::kNoProgress;
  std::vector<PassReport> passes;
  TriangleStatistics before, after;
  SurfaceReport surface;
  /// New number of each vertex; invalid for one that is gone. New vertices come behind those that were there.
  std::vector<VertexHandle> vertex_map;
  double seconds = 0;
};

/// Improves a surface without cells by the operators that `improve` uses on the surface of a mesh: the worst
/// triangle of every changed cluster gets better, within the same bounds. Throws InvalidInput for options out
/// of range, for triangles that name a vertex twice or one that is not there, and in a build without
/// OpenMesh.
TriangleResult improve_triangles(TriangleMesh& mesh, const TriangleOptions& options);

}  // namespace hfr

#endif
