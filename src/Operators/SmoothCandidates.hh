// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_SMOOTH_CANDIDATES_HH
#define HFR_OPERATORS_SMOOTH_CANDIDATES_HH

#include "Operators/Smooth.hh"
#include "kernels/candidates.h"

namespace hfr {

/// The paper's SMOOTH: candidate positions at distance r in 14 directions; the best one that raises the
/// star's worst cell is taken; when none does, r is halved. Works from inverted stars too, and with any
/// metric.
struct CandidateSearch {
  static constexpr double kVertexNanoseconds = 8'000;
  int halvings = HFR_CANDIDATE_HALVINGS;  ///< of r, from half the mean edge length of the star

  template <class Metric>
  std::optional<Move> operator()(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                                 const Metric& metric, std::span<const double> quality) const;
};

template <class Metric>
using SmoothCandidates = Smooth<CandidateSearch, Metric>;

}  // namespace hfr

#endif
