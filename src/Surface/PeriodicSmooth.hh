// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_PERIODIC_SMOOTH_HH
#define HFR_SURFACE_PERIODIC_SMOOTH_HH

#include <optional>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Quality/Damage.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {

/// Smoothing of vertices that periodic patches bind to each other (SurfaceMesh::orbit()): one step for all of
/// them, so that the worst cell at any of them gets better. Their stars are laid over one another and
/// searched as one, which away from the rims of patches is a star that goes all the way round.
template <class Metric>
struct PeriodicSmooth {
  struct Plan {
    std::vector<Vec3> targets;  ///< of the vertices of the orbit, in order
    double old_worst = 0, new_worst = 0;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell
  const SurfaceMesh* surface;
  double floor = kNoFloor;  ///< see Workspace::floor
  int halvings = 4;
  int iterations = 20;

  /// Nothing where the vertices may not move, share a cell, or no step helps. A step that would leave more
  /// cells inverted or flat does not help.
  std::optional<Plan> evaluate(const TetMesh& mesh, std::span<const VertexHandle> orbit) const;
};

}  // namespace hfr

#endif
