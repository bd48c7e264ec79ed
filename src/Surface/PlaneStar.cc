// SPDX-License-Identifier: BSD-3-Clause
// Garanzha, Kaporin, Kudryavtseva, Protais, Ray & Sokolov, Foldover-free maps in 50 lines of code, 2021, in
// the plane, one vertex at a time. Only + - * / and √.
#include "Surface/PlaneStar.hh"

#include <algorithm>
#include <array>
#include <optional>

namespace hfr::surface {
namespace {

constexpr int kSteps = 3;  // of Newton's method, and as many halvings of each
/// ε of a star without folds, in mean regular triangles.
constexpr double kFirmnessInPlane = 0.02;

/// S / χ, where 1/χ = 2 / (D + r), or without loss of digits 2 (r - D) / ε².
double energy_of(double s, double d, double eps2) {
  const double r = std::sqrt(d * d + eps2);
  return s * 2.0 * (d < 0 ? (r - d) / eps2 : 1.0 / (d + r));
}
double energy(std::span<const Side> sides, Point2 x, double eps2) {
  double sum = 0;
  for (const Side& side : sides) sum += energy_of(side.sum2(x), side.twice_area(x), eps2);
  return sum;
}

/// The step to where a quadratic form with this gradient and Hessian (xx, xy, yy) is least.
std::optional<Point2> solve(const std::array<double, 3>& h, Point2 g) {
  const double det = h[0] * h[2] - h[1] * h[1];
  if (!(h[0] > 0 && det > 1e-12 * h[0] * h[2])) return std::nullopt;
  return Point2{(h[1] * g.y - h[2] * g.x) / det, (h[1] * g.x - h[0] * g.y) / det};
}

/// Newton's step. What the gradients of S and of 1/χ add to the Hessian is left out where it makes it
/// indefinite.
std::optional<Point2> newton_step(std::span<const Side> sides, Point2 x, double eps2) {
  Point2 gradient;
  std::array<double, 3> convex{}, mixed{};
  for (const Side& side : sides) {
    const double s = side.sum2(x), d = side.twice_area(x);
    const double r = std::sqrt(d * d + eps2), e = energy_of(s, d, eps2);
    const Point2 along = side.b - side.a, n{-along.y, along.x};
    const Point2 gs = (1.0 / s) * (4.0 * x - 2.0 * (side.a + side.b));
    gradient = gradient + e * (gs - (1.0 / r) * n);
    const double flat = 4.0 * e / s, steep = e * (r + d) / (r * r * r), both = -e / r;
    convex[0] += flat + steep * n.x * n.x;
    convex[1] += steep * n.x * n.y;
    convex[2] += flat + steep * n.y * n.y;
    mixed[0] += 2.0 * both * gs.x * n.x;
    mixed[1] += both * (gs.x * n.y + gs.y * n.x);
    mixed[2] += 2.0 * both * gs.y * n.y;
  }
  std::array<double, 3> full = convex;
  for (std::size_t i = 0; i < full.size(); ++i) full[i] += mixed[i];
  if (const auto step = solve(full, gradient)) return step;
  return solve(convex, gradient);
}

}  // namespace

Point2 unfold_in_plane(std::span<const Side> sides, Point2 x) {
  double lowest = 0, regular = 0;
  for (const Side& side : sides) {
    lowest = std::min(lowest, side.twice_area(x));
    regular += regular_area(side.sum2(x));
  }
  const double firm = kFirmnessInPlane * regular / static_cast<double>(sides.size());
  const double eps2 = 4.0 * firm * (firm - lowest);
  if (!(eps2 > 0)) return x;
  double now = energy(sides, x, eps2);
  for (int i = 0; i < kSteps; ++i) {
    const auto step = newton_step(sides, x, eps2);
    if (!step) break;
    double length = 1, next = now;
    for (int halving = 0; halving <= kSteps; ++halving, length *= 0.5) {
      next = energy(sides, x + length * *step, eps2);
      if (next < now) break;
    }
    if (!(next < now)) break;
    x = x + length * *step;
    now = next;
  }
  return x;
}

}  // namespace hfr::surface
