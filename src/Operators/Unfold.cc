// SPDX-License-Identifier: BSD-3-Clause
// Garanzha, Kaporin, Kudryavtseva, Protais, Ray & Sokolov, Foldover-free maps in 50 lines of code, 2021: the
// regularisation, one vertex at a time as in Escobar et al., Simultaneous untangling and smoothing of
// tetrahedral meshes, 2003. S√S / χ is their shape term to the power 3/2, which spares the cube root. Only
// + - * / and √.
#include "Operators/Unfold.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace hfr {
namespace {

/// ε of a star without inverted cells, in mean regular cells.
constexpr double kFirmness = 0.02;
constexpr int kMaxHalvings = 6;
constexpr double kEnough = 1e-3;  // share of the energy that a further step has to save

/// S√S / χ. Where D is below 0, D + r loses digits, and 1/χ is taken as 2 (r - D) / ε².
double energy_of(double s, double d, double eps2) {
  const double r = std::sqrt(d * d + eps2);
  return s * std::sqrt(s) * 2.0 * (d < 0 ? (r - d) / eps2 : 1.0 / (d + r));
}

double energy(std::span<const hfr_star_cell> cells, Vec3 x, double eps2, double ceiling) {
  const hfr_real3 at = to_kernel(x);
  double sum = 0;
  for (const hfr_star_cell& cell : cells) {
    sum += energy_of(hfr_star_sum2(cell, at), hfr_star_det(cell, at), eps2);
    if (!(sum < ceiling)) return sum;
  }
  return sum;
}

using Matrix = std::array<double, 6>;  // xx xy xz yy yz zz

void add_outer(Matrix& m, double w, Vec3 a, Vec3 b) {
  m[0] += w * a.x * b.x;
  m[1] += 0.5 * w * (a.x * b.y + a.y * b.x);
  m[2] += 0.5 * w * (a.x * b.z + a.z * b.x);
  m[3] += w * a.y * b.y;
  m[4] += 0.5 * w * (a.y * b.z + a.z * b.y);
  m[5] += w * a.z * b.z;
}

std::optional<Vec3> solve(const Matrix& h, Vec3 g) {
  const double d0 = h[0];
  if (!(d0 > 0)) return std::nullopt;
  const double l1 = h[1] / d0;
  const double l2 = h[2] / d0;
  const double d1 = h[3] - l1 * h[1];
  if (!(d1 > 1e-12 * h[3])) return std::nullopt;
  const double e = h[4] - l1 * h[2];
  const double l3 = e / d1;
  const double d2 = h[5] - l2 * h[2] - l3 * e;
  if (!(d2 > 1e-12 * h[5])) return std::nullopt;
  const double y0 = -g.x;
  const double y1 = -g.y - l1 * y0;
  const double y2 = -g.z - l2 * y0 - l3 * y1;
  Vec3 x;
  x.z = y2 / d2;
  x.y = y1 / d1 - l3 * x.z;
  x.x = y0 / d0 - l1 * x.y - l2 * x.z;
  return x;
}

/// Newton's step. The energy is a product of two convex functions, S√S and 1/χ; what their gradients add to
/// the Hessian is left out where it makes it indefinite.
std::optional<Vec3> newton_step(std::span<const hfr_star_cell> cells, Vec3 x, double eps2) {
  Vec3 gradient;
  Matrix convex{};
  Matrix mixed{};
  const hfr_real3 at = to_kernel(x);
  for (const hfr_star_cell& cell : cells) {
    const double s = hfr_star_sum2(cell, at);
    const double d = hfr_star_det(cell, at);
    const double r = std::sqrt(d * d + eps2);
    const double e = energy_of(s, d, eps2);
    const Vec3 n{cell.normal.x, cell.normal.y, cell.normal.z};
    const Vec3 gs = (1.0 / s) * (6.0 * x - 2.0 * Vec3{cell.sum.x, cell.sum.y, cell.sum.z});
    gradient = gradient + e * (1.5 * gs - (1.0 / r) * n);
    // S√S: its Hessian over itself is 9/S·1 + 0.75 gs·gs; 1/χ: 2χ/r³ n·n.
    const double flat = 9.0 * e / s;
    convex[0] += flat;
    convex[3] += flat;
    convex[5] += flat;
    add_outer(convex, 0.75 * e, gs, gs);
    add_outer(convex, e * (r + d) / (r * r * r), n, n);
    add_outer(mixed, -3.0 * e / r, gs, n);
  }
  Matrix full = convex;
  for (std::size_t i = 0; i < 6; ++i) full[i] += mixed[i];
  if (const auto step = solve(full, gradient)) return step;
  return solve(convex, gradient);
}

}  // namespace

Vec3 unfold(const StarForm& star, int steps) {
  SpillArray<hfr_star_cell, Star::kCapacity> list(star.size());
  for (std::size_t i = 0; i < star.size(); ++i) list[i] = star.cell(i);
  const std::span<const hfr_star_cell> cells(list.data(), star.size());
  Vec3 place;
  if (cells.empty()) return place;
  double lowest = 0;
  double regular = 0;  // six times the volume of a regular cell with the edges of the star
  for (const hfr_star_cell& cell : cells) {
    lowest = std::min(lowest, cell.det);
    const double l2 = cell.sum2 / 6.0;
    regular += l2 * std::sqrt(l2) / std::sqrt(2.0);
  }
  const double firm = kFirmness * regular / static_cast<double>(cells.size());
  const double eps2 = 4.0 * firm * (firm - lowest);
  if (!(eps2 > 0)) return place;
  double now = energy(cells, place, eps2, std::numeric_limits<double>::infinity());
  for (int i = 0; i < steps; ++i) {
    const std::optional<Vec3> step = newton_step(cells, place, eps2);
    if (!step) break;
    double length = 1.0;
    double next = now;
    Vec3 candidate;
    for (int halving = 0; halving <= kMaxHalvings; ++halving, length *= 0.5) {
      candidate = place + length * *step;
      next = energy(cells, candidate, eps2, now);
      if (next < now) break;
    }
    if (!(next < now)) break;
    const bool enough = next > (1.0 - kEnough) * now;
    place = candidate;
    now = next;
    if (enough) break;
  }
  return place;
}

}  // namespace hfr
