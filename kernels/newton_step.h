/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_NEWTON_STEP_H
#define HFR_KERNELS_NEWTON_STEP_H

#include "star_newton.h"

/* Steps of Newton's method on a star; star_newton.h has what it needs of each cell. */
#define HFR_NEWTON_ENOUGH 0.995   /* a step that lowers the largest m by less ends the search */
#define HFR_NEWTON_MAX_HALVINGS 5 /* of a step that does not lower it */

/* Sums over the cells of a star, in the order of the cells. */
HFR_FN hfr_newton_share hfr_newton_zero(void) {
  hfr_newton_share s;
  s.gradient = hfr_make3(0.0, 0.0, 0.0);
  s.xx = s.xy = s.xz = s.yy = s.yz = s.zz = 0.0;
  return s;
}

HFR_FN hfr_newton_share hfr_newton_sum(hfr_newton_share a, hfr_newton_share b) {
  a.gradient =
      hfr_make3(a.gradient.x + b.gradient.x, a.gradient.y + b.gradient.y, a.gradient.z + b.gradient.z);
  a.xx += b.xx;
  a.xy += b.xy;
  a.xz += b.xz;
  a.yy += b.yy;
  a.yz += b.yz;
  a.zz += b.zz;
  return a;
}

/* Solution of Hessian * step = -gradient by LDL^T; `ok` is 0 when the matrix is not positive definite. */
typedef struct hfr_newton_step {
  hfr_real3 step;
  int ok;
} hfr_newton_step;

HFR_FN hfr_newton_step hfr_newton_solve(hfr_newton_share h) {
  hfr_newton_step result;
  const double d0 = h.xx;
  const double l1 = h.xy / d0;
  const double l2 = h.xz / d0;
  const double d1 = h.yy - l1 * h.xy;
  const double e = h.yz - l1 * h.xz;
  const double l3 = e / d1;
  const double d2 = h.zz - l2 * h.xz - l3 * e;
  const double y0 = -h.gradient.x;
  const double y1 = -h.gradient.y - l1 * y0;
  const double y2 = -h.gradient.z - l2 * y0 - l3 * y1;
  result.ok = (d0 > 0.0) & (d1 > 0.0) & (d2 > 0.0);
  result.step.z = y2 / d2;
  result.step.y = y1 / d1 - l3 * result.step.z;
  result.step.x = y0 / d0 - l1 * result.step.y - l2 * result.step.z;
  return result;
}

#endif
