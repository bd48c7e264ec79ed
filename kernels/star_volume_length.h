/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_STAR_VOLUME_LENGTH_H
#define HFR_KERNELS_STAR_VOLUME_LENGTH_H

#include "volume_length.h"

/* Volume-length of a cell as a function of one of its vertices, x, the other three fixed: 6V is linear in x
 * and the sum of squared edges S is quadratic with a constant second derivative, so eight coefficients say it
 * all. Positions are relative to the vertex's present place, which keeps the rounding small. */
typedef struct hfr_star_cell {
  hfr_real3 normal; /* gradient of 6V */
  double det;       /* 6V at x = 0 */
  hfr_real3 sum;    /* f0 + f1 + f2 */
  double sum2;      /* S at x = 0 */
} hfr_star_cell;

/* From the link face (f0, f1, f2), in the order that makes (f0, f1, f2, x) positive. */
HFR_FN hfr_star_cell hfr_make_star_cell(hfr_real3 f0, hfr_real3 f1, hfr_real3 f2) {
  hfr_star_cell s;
  const hfr_real3 e1 = hfr_sub3(f1, f0);
  const hfr_real3 e2 = hfr_sub3(f2, f0);
  const hfr_real3 e3 = hfr_sub3(f2, f1);
  s.normal = hfr_cross3(e1, e2);
  s.det = -hfr_dot3(s.normal, f0);
  s.sum = hfr_make3((f0.x + f1.x) + f2.x, (f0.y + f1.y) + f2.y, (f0.z + f1.z) + f2.z);
  s.sum2 = ((hfr_dot3(e1, e1) + hfr_dot3(e2, e2)) + hfr_dot3(e3, e3)) +
           ((hfr_dot3(f0, f0) + hfr_dot3(f1, f1)) + hfr_dot3(f2, f2));
  return s;
}

/* 6V with the vertex at x. */
HFR_FN double hfr_star_det(hfr_star_cell s, hfr_real3 x) { return s.det + hfr_dot3(s.normal, x); }

/* Sum of squared edges with the vertex at x. */
HFR_FN double hfr_star_sum2(hfr_star_cell s, hfr_real3 x) {
  return s.sum2 + (3.0 * hfr_dot3(x, x) - 2.0 * hfr_dot3(s.sum, x));
}

/* Decision form of volume-length with the vertex at x. */
HFR_FN double hfr_star_decision(hfr_star_cell s, hfr_real3 x) {
  return hfr_volume_length_of(hfr_star_det(s, x), hfr_star_sum2(s, x));
}

#endif
