/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_TET_VOLUME_H
#define HFR_KERNELS_TET_VOLUME_H

#include "base.h"

/* The factor before the permanent in hfr_orient6_bound: 8 units of 2^-53. Shewchuk (Adaptive precision
 * floating-point arithmetic and fast robust geometric predicates, 1997) proves (7 + 56*2^-53)*2^-53 for this
 * order of operations. */
#define HFR_ORIENT6_ERROR 8.8817841970012523e-16

/* Six times the signed volume: det(b - a, c - a, d - a), positive for a positive cell. The rounding depends
 * on the order of the vertices: evaluate a new cell in the order in which it will be stored. */
HFR_FN double hfr_orient6(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const hfr_real3 u = hfr_sub3(b, a);
  const hfr_real3 v = hfr_sub3(c, a);
  const hfr_real3 w = hfr_sub3(d, a);
  return hfr_dot3(u, hfr_cross3(v, w));
}

/* How far hfr_orient6 of the same vertices in the same order may be from the exact determinant of the
 * coordinates as stored. The last term stands for what underflows. */
HFR_FN double hfr_orient6_bound(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const hfr_real3 u = hfr_sub3(b, a);
  const hfr_real3 v = hfr_sub3(c, a);
  const hfr_real3 w = hfr_sub3(d, a);
  const double px = HFR_ABS(u.x) * (HFR_ABS(v.y * w.z) + HFR_ABS(v.z * w.y));
  const double py = HFR_ABS(u.y) * (HFR_ABS(v.z * w.x) + HFR_ABS(v.x * w.z));
  const double pz = HFR_ABS(u.z) * (HFR_ABS(v.x * w.y) + HFR_ABS(v.y * w.x));
  const double length = (HFR_ABS(u.x) + HFR_ABS(u.y)) + HFR_ABS(u.z);
  return HFR_ORIENT6_ERROR * ((px + py) + pz) + HFR_DOUBLE_MIN * (length + 1.0);
}

/* True only if |det| exceeds hfr_orient6_bound, whatever the shape: a cheap first test. `sum2` is the sum of
 * the six squared edges. The permanent in the bound is at most sqrt(3)*(sum2/3)^(3/2), so det^2
 * > 8.8e-32*sum2^3 is enough; the rest pays for rounding in sum2. */
#define HFR_FAR_FROM_FLAT 9.25e-32
HFR_FN int hfr_is_far_from_flat(double det, double sum2) {
  const double cube = (sum2 * sum2) * sum2;
  return (cube >= HFR_DOUBLE_MIN) & (det * det > HFR_FAR_FROM_FLAT * cube);
}

/* 1 surely positive, -1 surely inverted, 0 flat: the sign hides in rounding (or a coordinate is not finite).
 */
HFR_FN int hfr_orient_sign(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const double det = hfr_orient6(a, b, c, d);
  const double bound = hfr_orient6_bound(a, b, c, d);
  return (det > bound) - (det < -bound);
}

#endif
