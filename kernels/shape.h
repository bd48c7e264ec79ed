/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_SHAPE_H
#define HFR_KERNELS_SHAPE_H

#include "dihedral.h"

/* Further shape measures of a cell. All are 1 for the regular tetrahedron, 0 for a flat cell and negative for
 * an inverted one. */

/* Value of a quotient that a flat or overflowing cell may spoil. */
HFR_FN double hfr_finite_or_zero(double x) { return HFR_ABS(x) <= HFR_DOUBLE_MAX ? x : 0.0; }

/* Scaled Jacobian J = sqrt(2)*det / (the largest product of the three edge lengths at a corner) (Knupp 2003,
 * as in Verdict); the decision is J|J|. */
HFR_FN double hfr_scaled_jacobian_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const hfr_tet_frame f = hfr_make_frame(a, b, c, d);
  const double ka = (f.l01 * f.l02) * f.l03;
  const double kb = (f.l01 * f.l12) * f.l13;
  const double kc = (f.l02 * f.l12) * f.l23;
  const double kd = (f.l03 * f.l13) * f.l23;
  return hfr_finite_or_zero((2.0 * f.det) * HFR_ABS(f.det) / hfr_max(hfr_max(ka, kb), hfr_max(kc, kd)));
}

/* Shortest over longest edge, squared, with the sign of the volume. It does not see flat cells coming: an
 * additional view, no goal to work towards. */
HFR_FN double hfr_edge_ratio_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const hfr_tet_frame f = hfr_make_frame(a, b, c, d);
  const double low = hfr_min(hfr_min(hfr_min(f.l01, f.l02), hfr_min(f.l03, f.l12)), hfr_min(f.l13, f.l23));
  const double high = hfr_max(hfr_max(hfr_max(f.l01, f.l02), hfr_max(f.l03, f.l12)), hfr_max(f.l13, f.l23));
  const double ratio = hfr_finite_or_zero(low / high);
  return f.det > 0.0 ? ratio : f.det < 0.0 ? -ratio : 0.0;
}

/* Radius ratio 3r/R of the inscribed and the circumscribed sphere (Cavendish, Field & Frey 1985). With o =
 * u^2 (v x w) + v^2 (w x u) + w^2 (u x v): R = |o| / (2|det|), r = det / (|N0| + |N1| + |N2| + |N3|). The
 * areas are added, so their roots stay; sqrt rounds correctly everywhere. */
HFR_FN double hfr_radius_ratio_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const hfr_tet_frame f = hfr_make_frame(a, b, c, d);
  const double ox = (f.l01 * f.n1.x + f.l02 * f.n2.x) + f.l03 * f.n3.x;
  const double oy = (f.l01 * f.n1.y + f.l02 * f.n2.y) + f.l03 * f.n3.y;
  const double oz = (f.l01 * f.n1.z + f.l02 * f.n2.z) + f.l03 * f.n3.z;
  const double o = HFR_SQRT((ox * ox + oy * oy) + oz * oz);
  const double area = (HFR_SQRT(f.q0) + HFR_SQRT(f.q1)) + (HFR_SQRT(f.q2) + HFR_SQRT(f.q3));
  return hfr_finite_or_zero((6.0 * f.det) * HFR_ABS(f.det) / (area * o));
}

/* Six times the volume, or 0 when it hides in rounding. */
HFR_FN double hfr_volume_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const double det = hfr_orient6(a, b, c, d);
  return HFR_ABS(det) > hfr_orient6_bound(a, b, c, d) ? det : 0.0;
}

#endif
