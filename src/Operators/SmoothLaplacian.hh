// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_SMOOTH_LAPLACIAN_HH
#define HFR_OPERATORS_SMOOTH_LAPLACIAN_HH

#include "Operators/Smooth.hh"

namespace hfr {

/// Guarded Laplacian smoothing: the vertex moves towards the mean of its neighbours by `step` (1: the whole
/// way), and stays there only if the star's worst cell gets better. Taubin's filter is a pass with
/// kTaubinForth and one with kTaubinBack, which steps away from the mean.
struct LaplacianSearch {
  double step = 1.0;

  template <class Metric>
  std::optional<Move> operator()(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link,
                                 const Metric& metric, std::span<const double> quality) const;
};

inline constexpr LaplacianSearch kTaubinForth{0.33};
inline constexpr LaplacianSearch kTaubinBack{-0.34};

template <class Metric>
using SmoothLaplacian = Smooth<LaplacianSearch, Metric>;

}  // namespace hfr

#endif
