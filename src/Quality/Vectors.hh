// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_VECTORS_HH
#define HFR_QUALITY_VECTORS_HH

#include "kernels/base.h"

namespace hfr {

/// Sets of vector instructions that the formulas are compiled for.
enum class Vectors { kBaseline, kAvx2, kAvx512 };
/// The widest that this processor has. The environment variable HFR_VECTORS = baseline, avx2 or avx512 lowers
/// it, to show that results do not depend on it.
Vectors widest_vectors();

#if defined(__GNUC__) && defined(__x86_64__)
// Either compiler takes half as wide vectors unless it is told otherwise, each in its own words.
#ifdef __clang__
#define HFR_TARGET_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl"), min_vector_width(512)))
#else
#define HFR_TARGET_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl,prefer-vector-width=512")))
#endif
namespace detail {
template <auto kBody, class... Args>
HFR_TARGET_AVX512 auto call_avx512(Args... args) {
  return kBody(args...);
}
template <auto kBody, class... Args>
__attribute__((target("avx2"))) auto call_avx2(Args... args) {
  return kBody(args...);
}
}  // namespace detail
#endif

/// kBody(args...), in the copy for widest_vectors(). kBody is a function marked HFR_FN, so that it is
/// compiled anew inside each copy; arguments are pointers and numbers. Wider vectors change no bit:
/// contraction into fused multiply-adds is off in every copy. For loops that become vector instructions, the
/// file is compiled with hfr_vector_sources().
template <auto kBody, class... Args>
auto with_widest_vectors(Args... args) {
#if defined(__GNUC__) && defined(__x86_64__)
  switch (widest_vectors()) {
    case Vectors::kAvx512:
      return detail::call_avx512<kBody>(args...);
    case Vectors::kAvx2:
      return detail::call_avx2<kBody>(args...);
    case Vectors::kBaseline:
      break;
  }
#endif
  return kBody(args...);
}

}  // namespace hfr

#endif
