// SPDX-License-Identifier: BSD-3-Clause
// With m = S³/(6V)² of a cell (S the sum of squared edges), q² = 432/m, and the p-norm is (Σ mᵏ)^(1/k). Since
// grad log m = 3 grad S / S - 2 grad V / V and both derivatives are at hand in closed form, gradient and
// Hessian cost about 60 operations a cell. Only + - * / and comparisons are used.
#include "Operators/SmoothNewton.hh"

#include <algorithm>
#include <array>

#include "Operators/Metrics.hh"
#include "Operators/StarForm.hh"

namespace hfr {
namespace {

constexpr double kExponent = 4;    // k: weights are (m / m_max)^4
constexpr double kEnough = 0.995;  // a step that lowers the largest m by less ends the search
constexpr int kMaxHalvings = 5;    // of a step that does not lower it

struct Derivatives {
  Vec3 gradient;
  std::array<double, 6> hessian{};  // xx xy xz yy yz zz
};

/// Largest m over the star with the vertex moved by x; infinity where a cell is not positive.
double largest(std::span<const hfr_star_cell> cells, Vec3 x, double ceiling) {
  const hfr_real3 at = to_kernel(x);
  double top = 0;
  for (const hfr_star_cell& cell : cells) {
    const double det = hfr_star_det(cell, at);
    if (!(det > 0)) return std::numeric_limits<double>::infinity();
    const double s = hfr_star_sum2(cell, at);
    const double m = s * s * s / (det * det);
    if (m > top) top = m;
    if (!(top < ceiling)) return top;
  }
  return top;
}

/// Of the norm with the vertex moved by x, up to a common positive factor. m_max > 0 scales the weights.
Derivatives derivatives(std::span<const hfr_star_cell> cells, Vec3 x, double m_max) {
  Derivatives d;
  const hfr_real3 at = to_kernel(x);
  for (const hfr_star_cell& cell : cells) {
    const double r = 1.0 / hfr_star_det(cell, at);
    const double s = hfr_star_sum2(cell, at);
    const double t = 1.0 / s;
    const double ratio = s * s * s * r * r / m_max;
    const double ratio2 = ratio * ratio;
    const double w = ratio2 * ratio2;
    const Vec3 n = r * Vec3{cell.normal.x, cell.normal.y, cell.normal.z};
    const Vec3 g = t * (6.0 * x - 2.0 * Vec3{cell.sum.x, cell.sum.y, cell.sum.z});
    const Vec3 u = 3.0 * g - 2.0 * n;
    d.gradient = d.gradient + w * u;
    const double flat = 18.0 * t;
    const auto entry = [&](double ua, double ub, double na, double nb, double ga, double gb) {
      return w * (kExponent * ua * ub + 2.0 * na * nb - 3.0 * ga * gb);
    };
    d.hessian[0] += entry(u.x, u.x, n.x, n.x, g.x, g.x) + w * flat;
    d.hessian[1] += entry(u.x, u.y, n.x, n.y, g.x, g.y);
    d.hessian[2] += entry(u.x, u.z, n.x, n.z, g.x, g.z);
    d.hessian[3] += entry(u.y, u.y, n.y, n.y, g.y, g.y) + w * flat;
    d.hessian[4] += entry(u.y, u.z, n.y, n.z, g.y, g.z);
    d.hessian[5] += entry(u.z, u.z, n.z, n.z, g.z, g.z) + w * flat;
  }
  return d;
}

/// Solves hessian·x = -gradient by LDLᵀ; nothing when the matrix is not positive definite.
std::optional<Vec3> newton_step(const Derivatives& d) {
  const auto& h = d.hessian;
  const double d0 = h[0];
  if (!(d0 > 0)) return std::nullopt;
  const double l1 = h[1] / d0;
  const double l2 = h[2] / d0;
  const double d1 = h[3] - l1 * h[1];
  if (!(d1 > 0)) return std::nullopt;
  const double e = h[4] - l1 * h[2];
  const double l3 = e / d1;
  const double d2 = h[5] - l2 * h[2] - l3 * e;
  if (!(d2 > 0)) return std::nullopt;
  const double y0 = -d.gradient.x;
  const double y1 = -d.gradient.y - l1 * y0;
  const double y2 = -d.gradient.z - l2 * y0 - l3 * y1;
  Vec3 x;
  x.z = y2 / d2;
  x.y = y1 / d1 - l3 * x.z;
  x.x = y0 / d0 - l1 * x.y - l2 * x.z;
  return x;
}

/// Displacement that lowers the largest m as far as Newton's method on the norm takes it.
Vec3 minimise(std::span<const hfr_star_cell> cells, int iterations) {
  Vec3 place;
  double now = largest(cells, place, std::numeric_limits<double>::infinity());
  for (int i = 0; i < iterations; ++i) {
    const std::optional<Vec3> step = newton_step(derivatives(cells, place, now));
    if (!step) break;
    double length = 1.0;
    double next = now;
    Vec3 candidate;
    for (int halving = 0; halving <= kMaxHalvings; ++halving, length *= 0.5) {
      candidate = place + length * *step;
      next = largest(cells, candidate, now);
      if (next < now) break;
    }
    if (!(next < now)) break;
    const bool enough = next > kEnough * now;
    place = candidate;
    now = next;
    if (enough) break;
  }
  return place;
}

}  // namespace

template <class Metric>
std::optional<Move> NewtonSearch::operator()(const TetMesh& mesh, VertexHandle v,
                                             std::span<const HalfFaceHandle> link, const Metric& metric,
                                             std::span<const double> quality) const {
  constexpr bool kNative = std::is_same_v<Metric, VolumeLength>;
  Move move;
  move.old_worst = worst_of(link, quality);
  if (!(move.old_worst > 0)) return fallback(mesh, v, link, metric, quality);
  const StarForm star(mesh, v, link);
  const Vec3 place = minimise(star.cells(), iterations);
  if (!(place == Vec3{})) {
    move.target = mesh.point(v) + place;
    move.new_worst = worst_with(mesh, v, link, move.target, metric, move.old_worst);
    if (move.new_worst > move.old_worst) return move;
  }
  if constexpr (kNative)
    return std::nullopt;
  else
    return fallback(mesh, v, link, metric, quality);
}

HFR_INSTANTIATE_SEARCH(NewtonSearch)

}  // namespace hfr
