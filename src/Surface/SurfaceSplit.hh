// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_SPLIT_HH
#define HFR_SURFACE_SURFACE_SPLIT_HH

#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/GrownCells.hh"
#include "Operators/Operator.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {

/// Splits an edge of the boundary by a new vertex, in a cavity that begins with the open ring round the edge
/// and is dug as that of VertexInsertion; the vertex is moved within the facet, or along the edge where that
/// is a feature. Taken only if the worst new cell beats the worst old one by `gain`: a vertex and its cells
/// cost time ever after.
template <class Metric>
struct SurfaceSplit {
  /// Any cell of the ring; may_split() has allowed it. The seed of a plan also says which cells go.
  struct Seed {
    EdgeHandle edge;
    Growth growth;

    Seed() = default;
    explicit Seed(EdgeHandle e) : edge(e) { growth.first = CellHandle(e.idx() / 6); }
  };
  struct Plan : PlanBase {
    Seed seed;
    Vec3 place;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell
  const SurfaceMesh* surface;
  double gain = 1.02;
  std::size_t max_cells = 48;
  const CutRim* rim = nullptr;  ///< where the mesh is cut out of a larger one

  void scope(const TetMesh& mesh, const Seed& seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, const Seed& seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh& mesh, const Seed& seed) const;
};

}  // namespace hfr

#endif
