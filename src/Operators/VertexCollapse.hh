// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_VERTEX_REMOVAL_HH
#define HFR_OPERATORS_VERTEX_REMOVAL_HH

#include <cstdint>
#include <optional>
#include <span>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Operators/Operator.hh"

namespace hfr {

/// The paper's NODE operator: removes an inner vertex by joining one vertex of its link to all faces of the
/// link, which is the collapse of the edge between the two. Every link vertex is tried.
template <class Metric>
struct VertexCollapse {
  static constexpr double kSeedNanoseconds = 20'000;
  using Seed = VertexHandle;
  struct Plan : PlanBase {
    VertexHandle seed;
    VertexHandle apex;
  };

  Metric metric;
  std::span<const double> quality;       ///< decision value per cell
  std::span<const std::uint8_t> frozen;  ///< per vertex; see frozen_vertices()

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh&, Seed seed) const {
    return {seed, VertexHandle(), VertexHandle(), VertexHandle()};
  }
};

}  // namespace hfr

#endif
