// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/CellBlock.hh"

#include <cmath>
#include <numbers>

#include "Quality/Vectors.hh"
#include "kernels/dihedral.h"
#include "kernels/volume_length.h"

namespace hfr::detail {
namespace {

constexpr int kTerms = 12;

// Coefficients of the arc sine's power series in x².
constexpr std::array<double, kTerms> arcsine_series() {
  std::array<double, kTerms> a{1.0};
  for (int n = 0; n + 1 < kTerms; ++n) {
    const double odd = 2.0 * n + 1.0;
    a[static_cast<std::size_t>(n) + 1] =
        a[static_cast<std::size_t>(n)] * odd * odd / ((odd + 1.0) * (odd + 2.0));
  }
  return a;
}

template <int N = 0>
HFR_FN double horner(double x2) {
  constexpr double a = arcsine_series()[static_cast<std::size_t>(N)];
  if constexpr (N + 1 == kTerms)
    return a;
  else
    return a + x2 * horner<N + 1>(x2);
}

// Angle in [0, π] of the unit number (c, s), s ≥ 0, to 1e-12 where the sine is not tiny: halved three times,
// then the power series. Unlike std::atan2 it fits into a vector loop and gives the same bits with every C
// library.
HFR_FN double angle_of(double c, double s) {
  const double c2 = std::sqrt(hfr_max(0.5 + 0.5 * c, 0.0));
  const double s2 = c > 0.0 ? s / (2.0 * c2) : std::sqrt(hfr_max(0.5 - 0.5 * c, 0.0));
  const double c4 = std::sqrt(0.5 + 0.5 * c2);
  const double s4 = s2 / (2.0 * c4);
  const double c8 = std::sqrt(0.5 + 0.5 * c4);
  const double s8 = s4 / (2.0 * c8);
  return 8.0 * (s8 * horner(s8 * s8));
}

struct Unit {
  double c, s;
};

HFR_FN Unit times(Unit a, Unit b) { return {a.c * b.c - a.s * b.s, a.c * b.s + a.s * b.c}; }

// The dihedral between two faces: det·l and -N·N over |N||N|.
HFR_FN Unit dihedral(hfr_real3 nk, hfr_real3 nl, double sine, double scale) {
  return {-hfr_dot3(nk, nl) * scale, sine * scale};
}

HFR_FN void evaluate_cell(CellBlock& b, std::size_t i) {
  const hfr_real3 p0 = {b.x[0][i], b.y[0][i], b.z[0][i]};
  const hfr_real3 p1 = {b.x[1][i], b.y[1][i], b.z[1][i]};
  const hfr_real3 p2 = {b.x[2][i], b.y[2][i], b.z[2][i]};
  const hfr_real3 p3 = {b.x[3][i], b.y[3][i], b.z[3][i]};
  const hfr_tet_frame f = hfr_make_frame(p0, p1, p2, p3);
  const double min_dihedral = hfr_min_dihedral_of(f);
  const double volume_length = hfr_volume_length_decision(p0, p1, p2, p3);
  b.det[i] = f.det;
  b.min_dihedral[i] = min_dihedral;
  b.max_dihedral[i] = hfr_max_dihedral_of(f);
  b.volume_length[i] = volume_length;
  b.q[i] = hfr_volume_length_report(volume_length);
  b.length2[0][i] = f.l01;
  b.length2[1][i] = f.l02;
  b.length2[2][i] = f.l03;
  b.length2[3][i] = f.l12;
  b.length2[4][i] = f.l13;
  b.length2[5][i] = f.l23;
  b.min_length2[i] = hfr_min(hfr_min(hfr_min(f.l01, f.l02), hfr_min(f.l03, f.l12)), hfr_min(f.l13, f.l23));
  b.max_length2[i] = hfr_max(hfr_max(hfr_max(f.l01, f.l02), hfr_max(f.l03, f.l12)), hfr_max(f.l13, f.l23));
  const double l01 = std::sqrt(f.l01), l02 = std::sqrt(f.l02), l03 = std::sqrt(f.l03);
  const double l12 = std::sqrt(f.l12), l13 = std::sqrt(f.l13), l23 = std::sqrt(f.l23);
  b.length_sum[i] = ((l01 + l02) + (l03 + l12)) + (l13 + l23);
  const double r0 = 1.0 / std::sqrt(f.q0), r1 = 1.0 / std::sqrt(f.q1);
  const double r2 = 1.0 / std::sqrt(f.q2), r3 = 1.0 / std::sqrt(f.q3);
  const Unit a01 = dihedral(f.n2, f.n3, f.det * l01, r2 * r3);
  const Unit a02 = dihedral(f.n1, f.n3, f.det * l02, r1 * r3);
  const Unit a03 = dihedral(f.n1, f.n2, f.det * l03, r1 * r2);
  const Unit a12 = dihedral(f.n0, f.n3, f.det * l12, r0 * r3);
  const Unit a13 = dihedral(f.n0, f.n2, f.det * l13, r0 * r2);
  const Unit a23 = dihedral(f.n0, f.n1, f.det * l23, r0 * r1);
  b.cosine[0][i] = a01.c;
  b.cosine[1][i] = a02.c;
  b.cosine[2][i] = a03.c;
  b.cosine[3][i] = a12.c;
  b.cosine[4][i] = a13.c;
  b.cosine[5][i] = a23.c;
  // The dihedrals of a positive cell add up to something between 2π and 3π (Gaddum 1952), so the angle of the
  // product of the six tells the sum: one arc function instead of six.
  const Unit product = times(times(times(a01, a23), times(a02, a13)), times(a03, a12));
  b.angle_sum[i] = 2.0 * std::numbers::pi + angle_of(product.c, hfr_max(product.s, 0.0));
  b.min_angle[i] =
      angle_of(std::sqrt(hfr_max(1.0 - min_dihedral, 0.0)), std::sqrt(hfr_max(min_dihedral, 0.0)));
}

HFR_FN void evaluate_cells(CellBlock* block) {
  for (std::size_t i = 0; i < CellBlock::kSize; ++i) evaluate_cell(*block, i);
}

}  // namespace

void evaluate(CellBlock& block) { with_widest_vectors<evaluate_cells>(&block); }

}  // namespace hfr::detail
