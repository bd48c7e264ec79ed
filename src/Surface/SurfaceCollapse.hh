// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_COLLAPSE_HH
#define HFR_SURFACE_SURFACE_COLLAPSE_HH

#include <cstdint>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {

/// Surface vertex collapse: collapses a vertex of the surface along the edge of the surface that makes the
/// best cells of its star. A vertex of an interface takes the cells of both regions along, in one step. Cells
/// behind the star that a vertex would otherwise lose sight of belong to the scope and are created as they
/// were.
template <class Metric>
struct SurfaceCollapse {
  /// The vertex, and where its legal targets stand in `targets`; see SurfaceMesh::collapse_targets().
  struct Seed {
    VertexHandle vertex;
    std::uint32_t first = 0, n = 0;
  };
  struct Plan : PlanBase {
    Seed seed;
    VertexHandle onto;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell
  const SurfaceMesh* surface;
  std::span<const VertexHandle> targets;

  /// False where no collapse of v along an edge of the surface makes its star better, legal or not: such a
  /// vertex is no seed. Takes a fraction of the time of asking OpenMesh and evaluating.
  bool may_gain(const TetMesh& mesh, VertexHandle v) const;

  void scope(const TetMesh& mesh, const Seed& seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, const Seed& seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh&, const Seed& seed) const {
    return {seed.vertex, VertexHandle(), VertexHandle(), VertexHandle()};
  }
};

}  // namespace hfr

#endif
