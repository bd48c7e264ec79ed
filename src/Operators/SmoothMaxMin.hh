// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_SMOOTH_MAX_MIN_HH
#define HFR_OPERATORS_SMOOTH_MAX_MIN_HH

#include "Operators/Smooth.hh"
#include "Operators/SmoothCandidates.hh"

namespace hfr {

/// Max-min of the dihedral angles: moves the vertex to where the smallest sin² of its star is as large as a
/// non-smooth ascent takes it. For MinSine2 and MinDihedral; other metrics, and stars with inverted or flat
/// cells, go through the candidate search.
struct MaxMinSearch {
  static constexpr double kVertexNanoseconds = 30'000;
  int iterations = 24;  ///< at most; most stars need ten
  CandidateSearch fallback{};

  template <class Metric>
  std::optional<Move> operator()(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                                 const Metric& metric, std::span<const double> quality) const;
};

template <class Metric>
using SmoothMaxMin = Smooth<MaxMinSearch, Metric>;

}  // namespace hfr

#endif
