// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_FACE_SWAP_HH
#define HFR_OPERATORS_FACE_SWAP_HH

#include <optional>
#include <span>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Operators/Operator.hh"

namespace hfr {

/// 2-3 swap: removes an inner face and joins its two apexes by an edge. The paper's FACE operator.
template <class Metric>
struct FaceSwap {
  using Seed = HalfFaceHandle;  ///< either half-face of the face
  struct Plan : PlanBase {
    HalfFaceHandle seed;
  };

  Metric metric;
  std::span<const double> quality;  ///< decision value per cell

  void scope(const TetMesh& mesh, Seed seed, Scope& out) const;
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed seed) const;
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const;
  Tet identity(const TetMesh& mesh, Seed seed) const;
};

}  // namespace hfr

#endif
