/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_TRIANGLE_H
#define HFR_KERNELS_TRIANGLE_H

#include "base.h"

/* sin^2 of the smallest angle of a triangle, 0 where it is flat: twice the area over the two longer edges,
 * squared. The smallest angle is at most 60 degrees, so the order is that of the angles. */
HFR_FN double hfr_triangle_min_sin2(hfr_real3 a, hfr_real3 b, hfr_real3 c) {
  const hfr_real3 u = hfr_sub3(b, a);
  const hfr_real3 v = hfr_sub3(c, a);
  const hfr_real3 w = hfr_sub3(c, b);
  const hfr_real3 n = hfr_cross3(u, v);
  const double uu = hfr_dot3(u, u);
  const double vv = hfr_dot3(v, v);
  const double ww = hfr_dot3(w, w);
  const double area2 = hfr_dot3(n, n);
  const double uv = uu * vv;
  const double vw = vv * ww;
  const double wu = ww * uu;
  double longest = uv > vw ? uv : vw;
  longest = wu > longest ? wu : longest;
  return longest >= HFR_DOUBLE_MIN ? area2 / longest : 0.0;
}

#endif
