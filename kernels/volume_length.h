/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_VOLUME_LENGTH_H
#define HFR_KERNELS_VOLUME_LENGTH_H

#include "tet_volume.h"

/* Volume-length: q = 6*sqrt(2)*V / l_rms^3 (Parthasarathy, Graichen & Hathaway 1994), 1 for the regular
 * tetrahedron, 0 flat, negative inverted. Decisions use D = q|q| = 432*det|det| / S^3 with det = 6V and S the
 * sum of the six squared edges: no root, same order. Lengths from 1e-50 to 1e50. */

/* Up to this |D| counts as 0: flat. A cell above it is positive beyond rounding, whatever its shape:
 * 432*HFR_FAR_FROM_FLAT. */
#define HFR_VOLUME_LENGTH_FLAT 4.0e-29

/* Sum of the six squared edges from three of them at one corner. Since |u+v+w|^2 <= 3(u^2+v^2+w^2), nothing
 * cancels beyond a factor 7. */
HFR_FN double hfr_edge_sum2(hfr_real3 u, hfr_real3 v, hfr_real3 w) {
  const hfr_real3 t = hfr_make3((u.x + v.x) + w.x, (u.y + v.y) + w.y, (u.z + v.z) + w.z);
  return 4.0 * ((hfr_dot3(u, u) + hfr_dot3(v, v)) + hfr_dot3(w, w)) - hfr_dot3(t, t);
}

/* D from det = 6V and the sum of squared edges; 0 when flat, or when the sum is zero or out of range. */
HFR_FN double hfr_volume_length_of(double det, double sum2) {
  const double cube = (sum2 * sum2) * sum2;
  const double decision = (432.0 * det) * HFR_ABS(det) / cube;
  return (hfr_is_normal_positive(cube) & (HFR_ABS(decision) > HFR_VOLUME_LENGTH_FLAT)) ? decision : 0.0;
}

/* D of a cell: at most 1; > 0 only for a surely positive cell, 0 flat, < 0 inverted. */
HFR_FN double hfr_volume_length_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const hfr_real3 u = hfr_sub3(b, a);
  const hfr_real3 v = hfr_sub3(c, a);
  const hfr_real3 w = hfr_sub3(d, a);
  return hfr_volume_length_of(hfr_dot3(u, hfr_cross3(v, w)), hfr_edge_sum2(u, v, w));
}

/* Decision form to the paper's q, for reports. */
HFR_FN double hfr_volume_length_report(double decision) {
  const double root = HFR_SQRT(HFR_ABS(decision));
  return decision < 0.0 ? -root : root;
}

#endif
