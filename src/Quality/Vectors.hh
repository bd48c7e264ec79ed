// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_QUALITY_VECTORS_HH
#define HFR_QUALITY_VECTORS_HH

#include <cstddef>

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

/// kLanes doubles on which + - * / and comparisons work one by one, and `a < b ? x : y` chooses one by one.
/// For loops with which with_widest_vectors() gets nowhere, such as those that look for a place.
#ifdef __GNUC__
template <std::size_t kLanes>
struct LanesOf {
  typedef double Type __attribute__((vector_size(kLanes * sizeof(double))));
};
#else
template <std::size_t kLanes>
struct LanesOf {
  using Type = double;
};
#endif
template <std::size_t kLanes>
using Lanes = typename LanesOf<kLanes>::Type;

/// As with_widest_vectors(), of three bodies the one written for as many lanes as an instruction has.
template <auto kEight, auto kFour, auto kTwo, class... Args>
auto with_widest_lanes(Args... args) {
#if defined(__GNUC__) && defined(__x86_64__)
  switch (widest_vectors()) {
    case Vectors::kAvx512:
      return detail::call_avx512<kEight>(args...);
    case Vectors::kAvx2:
      return detail::call_avx2<kFour>(args...);
    case Vectors::kBaseline:
      break;
  }
#endif
  return kTwo(args...);
}

}  // namespace hfr

#endif
