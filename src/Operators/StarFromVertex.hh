// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_STAR_FROM_VERTEX_HH
#define HFR_OPERATORS_STAR_FROM_VERTEX_HH

#include <cstdint>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"

namespace hfr {

/// The clusters of the paper's three operators.
enum class Cluster { kEdge, kFace, kNode };

/// CLUSTER OPTIMIZATION in exactly the paper's form: takes the outer surface of the cluster, joins all its
/// triangles to each surface vertex in turn and, where insertion is allowed, to a new vertex in the middle,
/// and keeps the best if its worst cell beats the old worst. Here for --compat and as the centre insertion;
/// the stronger forms are EdgeRemoval, FaceSwap and VertexCollapse.
template <Cluster kCluster, class Metric>
struct StarFromVertex {
  struct Seed {
    CellHandle cell;
    std::uint8_t local = 0;  ///< local edge, half-face or corner
  };
  struct Plan : PlanBase {
    Seed seed;
    VertexHandle apex;  ///< Cavity::kNewVertex for the middle
    Vec3 middle;
  };

  Metric metric;
  std::span<const double> quality;       ///< decision value per cell
  std::span<const std::uint8_t> frozen;  ///< per vertex; a frozen vertex is not removed
  bool insert = false;                   ///< try the middle; taken only if all its cells are positive
  bool reconnect = true;                 ///< try the surface vertices

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh& mesh, Seed seed) const;
};

}  // namespace hfr

#endif
