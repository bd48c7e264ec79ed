// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_SURFACE_SWAP_HH
#define HFR_SURFACE_SURFACE_SWAP_HH

#include <array>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {

/// Surface edge swap: the n cells of the open ring round an edge (a, b) of the boundary are replaced by the
/// 2(n-1) cells that a triangulation of the polygon of their other vertices p0 … pn makes with a and with b.
/// The two boundary faces at (a, b) give way to the two at (p0, pn). All triangulations are searched, as in
/// EdgeRemoval. With n = 1 the only cell is peeled off; the cells round (p0, p1) then belong to the scope, so
/// that no other change can bring that edge to the surface at the same time.
template <class Metric>
struct SurfaceSwap {
  static constexpr int kMaxRing = 31;

  using Seed = EdgeHandle;  ///< 6·cell + local edge, of any cell of the ring; may_swap() has allowed it
  struct Plan : PlanBase {
    EdgeHandle seed;
    std::array<VertexHandle, 2> edge;  ///< that goes
    /// Middle vertex of each triangle of the best triangulation, in preorder from the side (0, n).
    std::array<std::uint8_t, kMaxRing - 1> apex;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell
  const SurfaceMesh* surface;

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh& mesh, Seed seed) const;
};

}  // namespace hfr

#endif
