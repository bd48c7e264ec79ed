// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_METRICS_HH
#define HFR_OPERATORS_METRICS_HH

#include "Quality/Damage.hh"
#include "Quality/Decisions.hh"
#include "Quality/Metrics.hh"
#include "kernels/untangle.h"

namespace hfr {

/// What the untangling stage maximises: volume-length of positive cells, volume of the others, those with an
/// angle below the floor last.
struct Untangling {
  double per_volume = 1;    ///< 1 / six times a typical cell volume of the mesh
  double floor = kNoFloor;  ///< see Workspace::floor

  double operator()(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const {
    return hfr_untangle_decision(to_real3(a), to_real3(b), to_real3(c), to_real3(d), per_volume, floor);
  }
};

/// Most cells are positive, and then it is volume-length.
inline void block_decisions(const Untangling& metric, const CornerBlock& block, CornerBlock::Lane& out) {
  block_decisions(VolumeLength{}, block, out);
  for (std::size_t i = 0; i < CornerBlock::kSize; ++i) {
    const auto at = [&](std::size_t k) { return Vec3{block.x[k][i], block.y[k][i], block.z[k][i]}; };
    if (!(out[i] > 0)) out[i] = metric(at(0), at(1), at(2), at(3));
  }
}

}  // namespace hfr

/// Instantiates an operator template for the metrics that runs use: the untangling's, the bulk's, the
/// polish's, and any other through a callable.
#define HFR_INSTANTIATE_FOR_METRICS(Operator) \
  template struct Operator<VolumeLength>;     \
  template struct Operator<Untangling>;       \
  template struct Operator<MinSine2>;         \
  template struct Operator<MinDihedral>;      \
  template struct Operator<CustomMetric>;

#endif
