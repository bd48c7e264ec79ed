// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Decisions.hh"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "kernels/dihedral.h"
#include "kernels/volume_length.h"

namespace hfr {
namespace {

using Formula = double (*)(hfr_real3, hfr_real3, hfr_real3, hfr_real3);
using Lane = CornerBlock::Lane;

template <Formula kFormula>
HFR_FN void evaluate_all(const CornerBlock& b, Lane& out) {
  for (std::size_t i = 0; i < CornerBlock::kSize; ++i) {
    out[i] = kFormula({b.x[0][i], b.y[0][i], b.z[0][i]}, {b.x[1][i], b.y[1][i], b.z[1][i]},
                      {b.x[2][i], b.y[2][i], b.z[2][i]}, {b.x[3][i], b.y[3][i], b.z[3][i]});
  }
}

// Wider vectors change no bit: contraction into fused multiply-adds is off in every copy.
#if defined(__GNUC__) && defined(__x86_64__)
template <Formula kFormula>
__attribute__((target("avx512f,avx512dq,avx512vl,prefer-vector-width=512"))) void evaluate_avx512(
    const CornerBlock& block, Lane& out) {
  evaluate_all<kFormula>(block, out);
}
template <Formula kFormula>
__attribute__((target("avx2"))) void evaluate_avx2(const CornerBlock& block, Lane& out) {
  evaluate_all<kFormula>(block, out);
}
template <Formula kFormula>
void evaluate(const CornerBlock& block, Lane& out) {
  switch (widest_vectors()) {
    case Vectors::kAvx512:
      return evaluate_avx512<kFormula>(block, out);
    case Vectors::kAvx2:
      return evaluate_avx2<kFormula>(block, out);
    case Vectors::kBaseline:
      return evaluate_all<kFormula>(block, out);
  }
}

Vectors vectors_of_processor() {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return Vectors::kAvx512;
  return __builtin_cpu_supports("avx2") ? Vectors::kAvx2 : Vectors::kBaseline;
}
#else
template <Formula kFormula>
void evaluate(const CornerBlock& block, Lane& out) {
  evaluate_all<kFormula>(block, out);
}

Vectors vectors_of_processor() { return Vectors::kBaseline; }
#endif

Vectors allowed_vectors() {
  const char* const name = std::getenv("HFR_VECTORS");
  const std::string_view wish = name ? name : "";
  const Vectors wished = wish == "baseline" ? Vectors::kBaseline
                         : wish == "avx2"   ? Vectors::kAvx2
                                            : Vectors::kAvx512;
  return std::min(wished, vectors_of_processor());
}

}  // namespace

Vectors widest_vectors() {
  static const Vectors vectors = allowed_vectors();
  return vectors;
}

void block_decisions(const VolumeLength&, const CornerBlock& block, Lane& out) {
  evaluate<hfr_volume_length_decision>(block, out);
}
void block_decisions(const MinSine2&, const CornerBlock& block, Lane& out) {
  evaluate<hfr_min_sin2_decision>(block, out);
}
void block_decisions(const MinDihedral&, const CornerBlock& block, Lane& out) {
  evaluate<hfr_min_dihedral_decision>(block, out);
}

}  // namespace hfr
