/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_STAR_NEWTON_H
#define HFR_KERNELS_STAR_NEWTON_H

#include "star_volume_length.h"

/* What Newton's method on a star needs of each cell. With m = S^3/(6V)^2 (S the sum of squared edges),
 * volume-length's q^2 = 432/m, and the p-norm is (sum m^k)^(1/k). Since grad log m = 3 grad S / S - 2 grad V
 * / V and both derivatives are at hand in closed form, gradient and Hessian cost about 60 operations a cell.
 */

#define HFR_NEWTON_EXPONENT 4.0 /* k: weights are (m / m_max)^4 */

/* m with the vertex at x; infinity where the cell is not positive. */
HFR_FN double hfr_star_m(hfr_star_cell cell, hfr_real3 x) {
  const double det = hfr_star_det(cell, x);
  const double s = hfr_star_sum2(cell, x);
  return det > 0.0 ? s * s * s / (det * det) : HFR_INFINITY;
}

/* One cell's share of the norm's gradient and Hessian (xx xy xz yy yz zz), up to a common positive factor. */
typedef struct hfr_newton_share {
  hfr_real3 gradient;
  double xx, xy, xz, yy, yz, zz;
} hfr_newton_share;

HFR_FN double hfr_newton_entry(double w, double ua, double ub, double na, double nb, double ga, double gb) {
  return w * (HFR_NEWTON_EXPONENT * ua * ub + 2.0 * na * nb - 3.0 * ga * gb);
}

/* With the vertex at x, where the cell is positive; m_max > 0 scales the weights. */
HFR_FN hfr_newton_share hfr_star_newton(hfr_star_cell cell, hfr_real3 x, double m_max) {
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
  hfr_newton_share share;
  share.gradient = hfr_make3(w * u.x, w * u.y, w * u.z);
  share.xx = hfr_newton_entry(w, u.x, u.x, n.x, n.x, g.x, g.x) + w * flat;
  share.xy = hfr_newton_entry(w, u.x, u.y, n.x, n.y, g.x, g.y);
  share.xz = hfr_newton_entry(w, u.x, u.z, n.x, n.z, g.x, g.z);
  share.yy = hfr_newton_entry(w, u.y, u.y, n.y, n.y, g.y, g.y) + w * flat;
  share.yz = hfr_newton_entry(w, u.y, u.z, n.y, n.z, g.y, g.z);
  share.zz = hfr_newton_entry(w, u.z, u.z, n.z, n.z, g.z, g.z) + w * flat;
  return share;
}

#endif
