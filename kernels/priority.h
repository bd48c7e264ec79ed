/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_PRIORITY_H
#define HFR_KERNELS_PRIORITY_H

#include "base.h"

/* Order among candidates of a round; integers only. In C++ these may be evaluated while compiling. */
#ifdef __OPENCL_C_VERSION__
typedef ulong hfr_u64;
#else
#include <stdint.h>
typedef uint64_t hfr_u64;
#endif
#ifdef __cplusplus
#define HFR_INT_FN constexpr
#else
#define HFR_INT_FN static inline
#endif

/* Mixes 64 bits (the finaliser of splitmix64). */
HFR_INT_FN hfr_u64 hfr_mix64(hfr_u64 x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9UL;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebUL;
  return x ^ (x >> 31);
}

/* Worse clusters first: 0 for what is inverted, flat or NaN, then one level a power of two of the decision
 * value, 1 to 15. `bits`: those of the double. */
HFR_INT_FN hfr_u64 hfr_quality_bucket(hfr_u64 bits) {
  const int exponent = (int)(bits >> 52) - 1023;           /* of a positive double */
  const int is_positive = bits - 1 < 0x7ff0000000000000UL; /* neither 0, nor negative, nor NaN */
  return !is_positive ? 0 : (hfr_u64)(exponent < -13 ? 1 : exponent > 0 ? 15 : 15 + exponent);
}

/* Priority of a candidate: smaller wins. Equal buckets are in the order of a hash of the vertices that name
 * the seed (0xffffffff where there are fewer than four), salted by the round. */
HFR_INT_FN hfr_u64 hfr_priority(hfr_u64 old_worst_bits, hfr_u64 v0, hfr_u64 v1, hfr_u64 v2, hfr_u64 v3,
                                hfr_u64 salt) {
  hfr_u64 h = hfr_mix64(salt + 0x9e3779b97f4a7c15UL);
  h = hfr_mix64(h ^ v0);
  h = hfr_mix64(h ^ v1);
  h = hfr_mix64(h ^ v2);
  h = hfr_mix64(h ^ v3);
  return hfr_quality_bucket(old_worst_bits) << 60 | h >> 4;
}

#endif
