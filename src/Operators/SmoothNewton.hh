// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_SMOOTH_NEWTON_HH
#define HFR_OPERATORS_SMOOTH_NEWTON_HH

#include "Operators/Smooth.hh"
#include "Operators/SmoothCandidates.hh"
#include "kernels/newton_step.h"

namespace hfr {

/// Newton's method on a p-norm of 1/q², which stands in for the largest of them: moves the vertex to where
/// the worst volume-length of its star is nearly as large as it can be. A star with inverted or flat cells,
/// where the norm has no meaning, goes through the candidate search instead. With another metric the place
/// found for volume-length is one more candidate that this metric judges.
struct NewtonSearch {
  int iterations = HFR_NEWTON_ITERATIONS;  ///< at most
  CandidateSearch fallback{};

  template <class Metric>
  std::optional<Move> operator()(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                                 const Metric& metric, std::span<const double> quality) const;
};

template <class Metric>
using SmoothNewton = Smooth<NewtonSearch, Metric>;

}  // namespace hfr

#endif
