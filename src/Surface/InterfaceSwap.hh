// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SURFACE_INTERFACE_SWAP_HH
#define HFR_SURFACE_INTERFACE_SWAP_HH

#include <array>
#include <optional>
#include <span>

#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {

/// Swap of an edge (a, b) of the interface between two regions, on both sides in one step: the cells round it
/// are two open rings that share the vertices p and q of the two interface faces. Each ring is triangulated
/// anew as in SurfaceSwap, and both triangulations have the side (p, q), so that the interface faces at (a,
/// b) give way to those at (p, q), and every created cell lies in the region of its ring. A side of a single
/// cell is left alone: it would have to change its region.
template <class Metric>
struct InterfaceSwap {
  static constexpr int kMaxSide = 31;  ///< cells of one region

  using Seed = EdgeHandle;  ///< 6·cell + local edge, of any cell of the ring; may_swap() has allowed it
  struct Plan : PlanBase {
    EdgeHandle seed;
    std::array<VertexHandle, 2> edge;  ///< that goes
    /// Per side, as in SurfaceSwap; the smaller region comes first.
    std::array<std::array<std::uint8_t, kMaxSide - 1>, 2> apex;
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
