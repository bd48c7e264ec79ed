/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_NEWTON_H
#define HFR_KERNELS_NEWTON_H

#include "order.h"
#include "star_volume_length.h"

/* Newton's method on the p-norm of m = S^3/(6V)^2 over the cells of a star; q^2 = 432/m. Since grad log m = 3
 * grad S / S - 2 grad V / V and both derivatives are at hand in closed form, gradient and Hessian cost about
 * 60 operations a cell. */
#define HFR_NEWTON_EXPONENT 4.0   /* p: weights are (m / m_max)^4 */
#define HFR_NEWTON_ENOUGH 0.995   /* a step that lowers the largest m by less ends the search */
#define HFR_NEWTON_MAX_HALVINGS 5 /* of a step that does not lower it */

/* m of a cell with the vertex at x; infinity when it is not positive. */
HFR_FN double hfr_newton_measure(hfr_star_cell cell, hfr_real3 x) {
  const double det = hfr_star_det(cell, x);
  const double s = hfr_star_sum2(cell, x);
  return det > 0.0 ? s * s * s / (det * det) : HFR_INFINITY;
}

/* Derivatives of the norm, up to a common positive factor. */
typedef struct hfr_newton_sums {
  double gx, gy, gz;
  double xx, xy, xz, yy, yz, zz;
} hfr_newton_sums;

HFR_FN hfr_newton_sums hfr_newton_zero(void) {
  hfr_newton_sums d;
  d.gx = d.gy = d.gz = 0.0;
  d.xx = d.xy = d.xz = d.yy = d.yz = d.zz = 0.0;
  return d;
}

HFR_FN double hfr_newton_entry(double w, double ua, double ub, double na, double nb, double ga, double gb) {
  return w * (HFR_NEWTON_EXPONENT * ua * ub + 2.0 * na * nb - 3.0 * ga * gb);
}

/* Adds a cell, with the vertex at x. m_max > 0 scales the weights. */
HFR_FN hfr_newton_sums hfr_newton_add(hfr_newton_sums d, hfr_star_cell cell, hfr_real3 x, double m_max) {
  const double r = 1.0 / hfr_star_det(cell, x);
  const double s = hfr_star_sum2(cell, x);
  const double t = 1.0 / s;
  const double ratio = s * s * s * r * r / m_max;
  const double ratio2 = ratio * ratio;
  const double w = ratio2 * ratio2;
  const hfr_real3 n = hfr_make3(r * cell.normal.x, r * cell.normal.y, r * cell.normal.z);
  const hfr_real3 g = hfr_make3(t * (6.0 * x.x - 2.0 * cell.sum.x), t * (6.0 * x.y - 2.0 * cell.sum.y),
                                t * (6.0 * x.z - 2.0 * cell.sum.z));
  const hfr_real3 u = hfr_make3(3.0 * g.x - 2.0 * n.x, 3.0 * g.y - 2.0 * n.y, 3.0 * g.z - 2.0 * n.z);
  const double flat = 18.0 * t;
  d.gx = d.gx + w * u.x;
  d.gy = d.gy + w * u.y;
  d.gz = d.gz + w * u.z;
  d.xx += hfr_newton_entry(w, u.x, u.x, n.x, n.x, g.x, g.x) + w * flat;
  d.xy += hfr_newton_entry(w, u.x, u.y, n.x, n.y, g.x, g.y);
  d.xz += hfr_newton_entry(w, u.x, u.z, n.x, n.z, g.x, g.z);
  d.yy += hfr_newton_entry(w, u.y, u.y, n.y, n.y, g.y, g.y) + w * flat;
  d.yz += hfr_newton_entry(w, u.y, u.z, n.y, n.z, g.y, g.z);
  d.zz += hfr_newton_entry(w, u.z, u.z, n.z, n.z, g.z, g.z) + w * flat;
  return d;
}

/* Solution of Hessian * step = -gradient by LDL^T; `ok` is 0 when the matrix is not positive definite. */
typedef struct hfr_newton_step {
  hfr_real3 step;
  int ok;
} hfr_newton_step;

HFR_FN hfr_newton_step hfr_newton_solve(hfr_newton_sums h) {
  hfr_newton_step result;
  const double d0 = h.xx;
  const double l1 = h.xy / d0;
  const double l2 = h.xz / d0;
  const double d1 = h.yy - l1 * h.xy;
  const double e = h.yz - l1 * h.xz;
  const double l3 = e / d1;
  const double d2 = h.zz - l2 * h.xz - l3 * e;
  const double y0 = -h.gx;
  const double y1 = -h.gy - l1 * y0;
  const double y2 = -h.gz - l2 * y0 - l3 * y1;
  result.ok = (d0 > 0.0) & (d1 > 0.0) & (d2 > 0.0);
  result.step.z = y2 / d2;
  result.step.y = y1 / d1 - l3 * result.step.z;
  result.step.x = y0 / d0 - l1 * result.step.y - l2 * result.step.z;
  return result;
}

#endif
