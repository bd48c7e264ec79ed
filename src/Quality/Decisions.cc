// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Decisions.hh"

#include "Quality/Vectors.hh"
#include "kernels/dihedral.h"
#include "kernels/volume_length.h"

namespace hfr {
namespace {

using Formula = double (*)(hfr_real3, hfr_real3, hfr_real3, hfr_real3);
using Lane = CornerBlock::Lane;

template <Formula kFormula>
HFR_FN void evaluate_all(const CornerBlock* b, Lane* out) {
  for (std::size_t i = 0; i < CornerBlock::kSize; ++i) {
    (*out)[i] = kFormula({b->x[0][i], b->y[0][i], b->z[0][i]}, {b->x[1][i], b->y[1][i], b->z[1][i]},
                         {b->x[2][i], b->y[2][i], b->z[2][i]}, {b->x[3][i], b->y[3][i], b->z[3][i]});
  }
}

}  // namespace

void block_decisions(const VolumeLength&, const CornerBlock& block, Lane& out) {
  with_widest_vectors<evaluate_all<hfr_volume_length_decision>>(&block, &out);
}
void block_decisions(const MinSine2&, const CornerBlock& block, Lane& out) {
  with_widest_vectors<evaluate_all<hfr_min_sin2_decision>>(&block, &out);
}
void block_decisions(const MinDihedral&, const CornerBlock& block, Lane& out) {
  with_widest_vectors<evaluate_all<hfr_min_dihedral_decision>>(&block, &out);
}

}  // namespace hfr
