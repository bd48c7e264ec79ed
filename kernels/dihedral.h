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
  double det;                          /* hfr_orient6, or 0 when it is inside its rounding bound */
  double l01, l02, l03, l12, l13, l23; /* squared edge lengths */
  hfr_real3 n0, n1, n2, n3;            /* outward normals */
  double q0, q1, q2, q3;               /* their squared lengths: 4*area^2 */
} hfr_tet_frame;

HFR_FN hfr_tet_frame hfr_make_frame(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  hfr_tet_frame f;
  double det, sum2;
  const hfr_real3 u = hfr_sub3(b, a);
  const hfr_real3 v = hfr_sub3(c, a);
  const hfr_real3 w = hfr_sub3(d, a);
  const hfr_real3 bc = hfr_sub3(c, b);
  const hfr_real3 bd = hfr_sub3(d, b);
  const hfr_real3 cd = hfr_sub3(d, c);
  const hfr_real3 vw = hfr_cross3(v, w);
  det = hfr_dot3(u, vw);
  f.l01 = hfr_dot3(u, u);
  f.l02 = hfr_dot3(v, v);
  f.l03 = hfr_dot3(w, w);
  f.l12 = hfr_dot3(bc, bc);
  f.l13 = hfr_dot3(bd, bd);
  f.l23 = hfr_dot3(cd, cd);
  f.n0 = hfr_cross3(bc, bd);
  f.n1 = hfr_make3(-vw.x, -vw.y, -vw.z);
  f.n2 = hfr_cross3(u, w);
  f.n3 = hfr_cross3(v, u);
  f.q0 = hfr_dot3(f.n0, f.n0);
  f.q1 = hfr_dot3(vw, vw);
  f.q2 = hfr_dot3(f.n2, f.n2);
  f.q3 = hfr_dot3(f.n3, f.n3);
  sum2 = ((f.l01 + f.l02) + (f.l03 + f.l12)) + (f.l13 + f.l23);
  f.det = (hfr_is_far_from_flat(det, sum2) || HFR_ABS(det) > hfr_orient6_bound(a, b, c, d)) ? det : 0.0;
  return f;
}

/* Per edge (i, j): l^2 * N_i^2 * N_j^2, its sin^2 but for a factor common to the cell. */
typedef struct hfr_edge_terms {
  double m01, m02, m03, m12, m13, m23;
} hfr_edge_terms;

HFR_FN hfr_edge_terms hfr_make_edge_terms(const hfr_tet_frame f) {
  hfr_edge_terms t;
  t.m01 = f.l01 * (f.q0 * f.q1);
  t.m02 = f.l02 * (f.q0 * f.q2);
  t.m03 = f.l03 * (f.q0 * f.q3);
  t.m12 = f.l12 * (f.q1 * f.q2);
  t.m13 = f.l13 * (f.q1 * f.q3);
  t.m23 = f.l23 * (f.q2 * f.q3);
  return t;
}

HFR_FN double hfr_min_term(const hfr_edge_terms t) {
  return hfr_min(hfr_min(hfr_min(t.m01, t.m02), hfr_min(t.m03, t.m12)), hfr_min(t.m13, t.m23));
}

HFR_FN double hfr_max_term(const hfr_edge_terms t) {
  return hfr_max(hfr_max(hfr_max(t.m01, t.m02), hfr_max(t.m03, t.m12)), hfr_max(t.m13, t.m23));
}

/* Edge term -> sin^2 with the sign of the volume; 0 when the cell is flat. */
HFR_FN double hfr_signed_sin2(const hfr_tet_frame f, double term) {
  const double s = (term / (f.q0 * f.q1)) * ((f.det * HFR_ABS(f.det)) / (f.q2 * f.q3));
  return HFR_ABS(s) <= 2.0 ? s : 0.0; /* neither NaN nor infinite */
}

/* Terms of the edges whose side * cos is positive (side = 1: acute angles, -1: obtuse); the largest double
 * stands for the others. */
HFR_FN hfr_edge_terms hfr_terms_on_side(const hfr_tet_frame f, const hfr_edge_terms t, double side) {
  hfr_edge_terms r;
  r.m01 = side * hfr_dot3(f.n2, f.n3) < 0.0 ? t.m01 : HFR_DOUBLE_MAX;
  r.m02 = side * hfr_dot3(f.n1, f.n3) < 0.0 ? t.m02 : HFR_DOUBLE_MAX;
  r.m03 = side * hfr_dot3(f.n1, f.n2) < 0.0 ? t.m03 : HFR_DOUBLE_MAX;
  r.m12 = side * hfr_dot3(f.n0, f.n3) < 0.0 ? t.m12 : HFR_DOUBLE_MAX;
  r.m13 = side * hfr_dot3(f.n0, f.n2) < 0.0 ? t.m13 : HFR_DOUBLE_MAX;
  r.m23 = side * hfr_dot3(f.n0, f.n1) < 0.0 ? t.m23 : HFR_DOUBLE_MAX;
  return r;
}

/* Smallest over the six dihedrals of sin^2, with the sign of the volume: at most 8/9 (regular). Angles near 0
 * and near 180 degrees count alike. */
HFR_FN double hfr_min_sin2_of(const hfr_tet_frame f) {
  return hfr_signed_sin2(f, hfr_min_term(hfr_make_edge_terms(f)));
}

HFR_FN double hfr_min_sin2_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  return hfr_min_sin2_of(hfr_make_frame(a, b, c, d));
}

/* sin^2 of the smallest dihedral itself, with the sign of the volume: at most 8/9 (70.53 degrees, regular).
 * The smallest dihedral of a tetrahedron never exceeds 70.53 degrees (Gaddum 1952), so it is the smallest
 * among the acute ones, where sin^2 is monotone; obtuse angles do not count. A goal of t degrees is met when
 * this is at least sin^2(t). */
HFR_FN double hfr_min_dihedral_of(const hfr_tet_frame f) {
  const double m = hfr_min_term(hfr_terms_on_side(f, hfr_make_edge_terms(f), 1.0));
  return m < HFR_DOUBLE_MAX ? hfr_signed_sin2(f, m) : 0.0;
}

HFR_FN double hfr_min_dihedral_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  return hfr_min_dihedral_of(hfr_make_frame(a, b, c, d));
}

/* Larger where the largest dihedral is smaller: with t that angle, sin^2(t) when obtuse and 2 - sin^2(t) when
 * not (10/9 for the regular one, 1 at 90 degrees, 0 at 180 degrees), with the sign of the volume. */
HFR_FN double hfr_max_dihedral_of(const hfr_tet_frame f) {
  const hfr_edge_terms terms = hfr_make_edge_terms(f);
  const double obtuse = hfr_min_term(hfr_terms_on_side(f, terms, -1.0));
  const double s = hfr_signed_sin2(f, obtuse < HFR_DOUBLE_MAX ? obtuse : hfr_max_term(terms));
  const double complement = s > 0.0 ? 2.0 - s : s < 0.0 ? -2.0 - s : 0.0;
  return obtuse < HFR_DOUBLE_MAX ? s : complement;
}

HFR_FN double hfr_max_dihedral_decision(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  return hfr_max_dihedral_of(hfr_make_frame(a, b, c, d));
}

/* sin^2 of half the dihedral that a positive cell with the face (a, c, d) and the face (b, c, d) has at their
 * edge (c, d). NaN where one of the faces has no area. */
HFR_FN double hfr_half_dihedral_sin2(hfr_real3 a, hfr_real3 b, hfr_real3 c, hfr_real3 d) {
  const hfr_real3 edge = hfr_sub3(d, c);
  const hfr_real3 na = hfr_cross3(edge, hfr_sub3(a, c));
  const hfr_real3 nb = hfr_cross3(edge, hfr_sub3(b, c));
  return 0.5 - 0.5 * (hfr_dot3(na, nb) / HFR_SQRT(hfr_dot3(na, na) * hfr_dot3(nb, nb)));
}

/* Cosine and sine of a dihedral, both times the same factor >= 0: t = atan2(sine, cosine), negative in an
 * inverted cell; 0 or 180 degrees in a flat one. For reports. */
typedef struct hfr_cos_sin {
  double cosine, sine;
} hfr_cos_sin;

HFR_FN hfr_cos_sin hfr_make_cos_sin(double det, double length2, hfr_real3 nk, hfr_real3 nl) {
  hfr_cos_sin r;
  r.cosine = 0.0 - hfr_dot3(nk, nl); /* never -0: atan2(0, -0) is 180 degrees */
  r.sine = det * HFR_SQRT(length2);
  return r;
}

/* The dihedral at local edge 0 .. 5 (01 02 03 12 13 23). */
HFR_FN hfr_cos_sin hfr_dihedral_cos_sin(const hfr_tet_frame f, int edge) {
  switch (edge) {
    case 0:
      return hfr_make_cos_sin(f.det, f.l01, f.n2, f.n3);
    case 1:
      return hfr_make_cos_sin(f.det, f.l02, f.n1, f.n3);
    case 2:
      return hfr_make_cos_sin(f.det, f.l03, f.n1, f.n2);
    case 3:
      return hfr_make_cos_sin(f.det, f.l12, f.n0, f.n3);
    case 4:
      return hfr_make_cos_sin(f.det, f.l13, f.n0, f.n2);
    default:
      return hfr_make_cos_sin(f.det, f.l23, f.n0, f.n1);
  }
}

#endif
