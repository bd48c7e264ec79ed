// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_GRADIENTS_HH
#define HFR_TRANSFER_GRADIENTS_HH

#include <cstddef>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// How the gradient of a field of vertices follows from its values round a vertex: by least squares over the
/// edges of the vertex, each with the weight 1/length⁴. Exact for linear functions. Made once, for all
/// fields, for the corners of the old cells that vertices have been put in.
class Gradients {
 public:
  /// The gradient is the sum of weight · (value at the neighbour - value at the vertex).
  struct Term {
    VertexHandle neighbour;
    Vec3 weight;
  };

  /// For the corners of these cells.
  Gradients(const TetMesh& old, std::span<const CellHandle> cells, par::Policy policy);

  /// Of an old vertex; none where its edges lie in one plane, and of other vertices than those corners.
  std::span<const Term> terms(VertexHandle v) const;

 private:
  std::vector<VertexHandle> vertices_;  // ascending
  std::vector<std::vector<Term>> terms_;
};

}  // namespace hfr

#endif
