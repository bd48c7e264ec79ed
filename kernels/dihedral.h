/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef HFR_KERNELS_DIHEDRAL_H
#define HFR_KERNELS_DIHEDRAL_H

#include "tet_volume.h"

/* Dihedral angles. For the edge (i, j) between the faces opposite k and l, with l^2 its squared length, N the
 * outward face normals of length 2A and det = 6V:
 *   sin t = 3Vl / (2 A_k A_l), so sin^2t = det^2*l^2 / (N_k^2 N_l^2);  cos t = -N_k*N_l / (|N_k||N_l|)
 * (Shewchuk, What is a good linear element?, 2002). Over the common denominator N_0^2 N_1^2 N_2^2 N_3^2 six
 * divisions become two. Decision forms carry the sign of the volume, so that an inverted cell is below every
 * positive one and a cell rises through 0 when it is untangled. Lengths from 1e-30 to 1e30. */

/* What all dihedral forms need. Edges in the order 01 02 03 12 13 23; normal k belongs to the face opposite
 * corner k and points outwards in a positive cell. */
typedef struct hfr_tet_frame {
  double det;        /* hfr_orient6, or 0 when it is inside its rounding bound */
  double length2[6]; /* squared edge lengths */
  hfr_real3 normal[4];
  double normal2[4]; /* squared lengths of the normals: 4*area^2 */
} hfr_tet_frame;

HFR_FN hfr_tet_frame hfr_make_frame(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  hfr_tet_frame f;
  double det;
  const hfr_real3 u = hfr_sub3(b, a);
  const hfr_real3 v = hfr_sub3(c, a);
  const hfr_real3 w = hfr_sub3(d, a);
  const hfr_real3 bc = hfr_sub3(c, b);
  const hfr_real3 bd = hfr_sub3(d, b);
  const hfr_real3 cd = hfr_sub3(d, c);
  const hfr_real3 vw = hfr_cross3(v, w);
  det = hfr_dot3(u, vw);
  f.det = HFR_ABS(det) > hfr_orient6_bound(a, b, c, d) ? det : 0.0;
  f.length2[0] = hfr_dot3(u, u);
  f.length2[1] = hfr_dot3(v, v);
  f.length2[2] = hfr_dot3(w, w);
  f.length2[3] = hfr_dot3(bc, bc);
  f.length2[4] = hfr_dot3(bd, bd);
  f.length2[5] = hfr_dot3(cd, cd);
  f.normal[0] = hfr_cross3(bc, bd);
  f.normal[1] = hfr_make3(-vw.x, -vw.y, -vw.z);
  f.normal[2] = hfr_cross3(u, w);
  f.normal[3] = hfr_cross3(v, u);
  f.normal2[0] = hfr_dot3(f.normal[0], f.normal[0]);
  f.normal2[1] = hfr_dot3(vw, vw);
  f.normal2[2] = hfr_dot3(f.normal[2], f.normal[2]);
  f.normal2[3] = hfr_dot3(f.normal[3], f.normal[3]);
  return f;
}

/* det|det|*m / (N_0^2 N_1^2 N_2^2 N_3^2), where m = l^2*N_i^2*N_j^2 of an edge (i, j): its signed sin^2. 0
 * when the cell is flat. */
HFR_FN double hfr_signed_sin2(const hfr_tet_frame f, double m) {
  const double p = f.normal2[0] * f.normal2[1];
  const double q = f.normal2[2] * f.normal2[3];
  return (hfr_is_normal_positive(p) & hfr_is_normal_positive(q) & (m <= HFR_DOUBLE_MAX))
             ? (m / p) * ((f.det * HFR_ABS(f.det)) / q)
             : 0.0;
}

/* Smallest over the six dihedrals of sin^2, with the sign of the volume: at most 8/9 (regular). Small angles
 * and angles near 180 degrees count alike. */
HFR_FN double hfr_min_sin2_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const hfr_tet_frame f = hfr_make_frame(a, b, c, d);
  const double m01 = f.length2[0] * (f.normal2[0] * f.normal2[1]);
  const double m02 = f.length2[1] * (f.normal2[0] * f.normal2[2]);
  const double m03 = f.length2[2] * (f.normal2[0] * f.normal2[3]);
  const double m12 = f.length2[3] * (f.normal2[1] * f.normal2[2]);
  const double m13 = f.length2[4] * (f.normal2[1] * f.normal2[3]);
  const double m23 = f.length2[5] * (f.normal2[2] * f.normal2[3]);
  return hfr_signed_sin2(f, hfr_min(hfr_min(hfr_min(m01, m02), hfr_min(m03, m12)), hfr_min(m13, m23)));
}

/* l^2*N_i^2*N_j^2 of the edge (i, j) between the faces k and l if its angle is acute, else the largest
 * double.
 */
HFR_FN double hfr_acute_term(const hfr_tet_frame f, int edge, int i, int j, int k, int l) {
  const double term = f.length2[edge] * (f.normal2[i] * f.normal2[j]);
  return hfr_dot3(f.normal[k], f.normal[l]) < 0.0 ? term : HFR_DOUBLE_MAX;
}

/* sin^2 of the smallest dihedral itself, with the sign of the volume: at most 8/9 (70.53 degrees, regular).
 * The smallest dihedral of a tetrahedron never exceeds 70.53 degrees (Gaddum 1952), so it is the smallest
 * sin^2 among the acute ones, and sin^2 is monotone there; obtuse angles do not count. An angle goal t is met
 * when this >= sin^2t. */
HFR_FN double hfr_min_dihedral_of(const hfr_tet_frame f) {
  const double m01 = hfr_acute_term(f, 0, 0, 1, 2, 3);
  const double m02 = hfr_acute_term(f, 1, 0, 2, 1, 3);
  const double m03 = hfr_acute_term(f, 2, 0, 3, 1, 2);
  const double m12 = hfr_acute_term(f, 3, 1, 2, 0, 3);
  const double m13 = hfr_acute_term(f, 4, 1, 3, 0, 2);
  const double m23 = hfr_acute_term(f, 5, 2, 3, 0, 1);
  const double m = hfr_min(hfr_min(hfr_min(m01, m02), hfr_min(m03, m12)), hfr_min(m13, m23));
  return m < HFR_DOUBLE_MAX ? hfr_signed_sin2(f, m) : 0.0;
}

HFR_FN double hfr_min_dihedral_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  return hfr_min_dihedral_of(hfr_make_frame(a, b, c, d));
}

/* l^2*N_i^2*N_j^2 of the edge (i, j) between the faces k and l if its angle is obtuse, else the largest
 * double.
 */
HFR_FN double hfr_obtuse_term(const hfr_tet_frame f, int edge, int i, int j, int k, int l) {
  const double term = f.length2[edge] * (f.normal2[i] * f.normal2[j]);
  return hfr_dot3(f.normal[k], f.normal[l]) > 0.0 ? term : HFR_DOUBLE_MAX;
}

/* Larger is better where the largest dihedral is smaller: with t that angle, sin^2t when obtuse and 2 -
 * sin^2t = 1 + cos^2t when not (10/9 for the regular one, 1 at 90 degrees, 0 at 180 degrees), with the sign
 * of the volume. */
HFR_FN double hfr_max_dihedral_of(const hfr_tet_frame f) {
  const double m01 = hfr_obtuse_term(f, 0, 0, 1, 2, 3);
  const double m02 = hfr_obtuse_term(f, 1, 0, 2, 1, 3);
  const double m03 = hfr_obtuse_term(f, 2, 0, 3, 1, 2);
  const double m12 = hfr_obtuse_term(f, 3, 1, 2, 0, 3);
  const double m13 = hfr_obtuse_term(f, 4, 1, 3, 0, 2);
  const double m23 = hfr_obtuse_term(f, 5, 2, 3, 0, 1);
  const double m = hfr_min(hfr_min(hfr_min(m01, m02), hfr_min(m03, m12)), hfr_min(m13, m23));
  const double s01 = f.length2[0] * (f.normal2[0] * f.normal2[1]);
  const double s02 = f.length2[1] * (f.normal2[0] * f.normal2[2]);
  const double s03 = f.length2[2] * (f.normal2[0] * f.normal2[3]);
  const double s12 = f.length2[3] * (f.normal2[1] * f.normal2[2]);
  const double s13 = f.length2[4] * (f.normal2[1] * f.normal2[3]);
  const double s23 = f.length2[5] * (f.normal2[2] * f.normal2[3]);
  const double s = hfr_max(hfr_max(hfr_max(s01, s02), hfr_max(s03, s12)), hfr_max(s13, s23));
  const double largest = hfr_signed_sin2(f, s);
  if (m < HFR_DOUBLE_MAX) return hfr_signed_sin2(f, m);
  return largest > 0.0 ? 2.0 - largest : largest < 0.0 ? -2.0 - largest : 0.0;
}

HFR_FN double hfr_max_dihedral_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  return hfr_max_dihedral_of(hfr_make_frame(a, b, c, d));
}

/* Cosine and sine of a dihedral, both times the same factor |N_k||N_l| >= 0: t = atan2(sine, cosine),
 * negative in an inverted cell. */
typedef struct hfr_cos_sin {
  double cosine, sine;
} hfr_cos_sin;

HFR_FN hfr_cos_sin hfr_make_cos_sin(double det, double length2, hfr_real3 nk, hfr_real3 nl) {
  hfr_cos_sin r;
  r.cosine = 0.0 - hfr_dot3(nk, nl); /* never -0: atan2(0, -0) is 180 degrees */
  r.sine = det * HFR_SQRT(length2);
  return r;
}

/* The dihedral at local edge 0 .. 5 (01 02 03 12 13 23). For reports. */
HFR_FN hfr_cos_sin hfr_dihedral_cos_sin(const hfr_tet_frame f, int edge) {
  const int k = edge < 3 ? (edge == 0 ? 2 : 1) : 0;
  const int l = edge == 5 ? 1 : (edge == 2 || edge == 4) ? 2 : 3;
  return hfr_make_cos_sin(f.det, f.length2[edge], f.normal[k], f.normal[l]);
}

#endif
