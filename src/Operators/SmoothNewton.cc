// SPDX-License-Identifier: BSD-3-Clause
// Newton's method on the p-norm of a star; see kernels/star_newton.h. Only + - * / and comparisons are used.
#include "Operators/SmoothNewton.hh"

#include <limits>

#include "Operators/Metrics.hh"
#include "Operators/StarForm.hh"

namespace hfr {
namespace {

constexpr double kEnough = 0.995;  // a step that lowers the largest m by less ends the search
constexpr int kMaxHalvings = 5;    // of a step that does not lower it

/// Solves hessian·x = -gradient by LDLᵀ; nothing when the matrix is not positive definite.
std::optional<Vec3> newton_step(const hfr_newton_share& h) {
  const double d0 = h.xx;
  if (!(d0 > 0)) return std::nullopt;
  const double l1 = h.xy / d0;
  const double l2 = h.xz / d0;
  const double d1 = h.yy - l1 * h.xy;
  if (!(d1 > 0)) return std::nullopt;
  const double e = h.yz - l1 * h.xz;
  const double l3 = e / d1;
  const double d2 = h.zz - l2 * h.xz - l3 * e;
  if (!(d2 > 0)) return std::nullopt;
  const double y0 = -h.gradient.x;
  const double y1 = -h.gradient.y - l1 * y0;
  const double y2 = -h.gradient.z - l2 * y0 - l3 * y1;
  Vec3 x;
  x.z = y2 / d2;
  x.y = y1 / d1 - l3 * x.z;
  x.x = y0 / d0 - l1 * x.y - l2 * x.z;
  return x;
}

/// Displacement that lowers the largest m as far as Newton's method on the norm takes it.
Vec3 minimise(const StarForm& star, int iterations) {
  Vec3 place;
  double now = star.largest_m(place, std::numeric_limits<double>::infinity());
  for (int i = 0; i < iterations; ++i) {
    const std::optional<Vec3> step = newton_step(star.newton(place, now));
    if (!step) break;
    double length = 1.0;
    double next = now;
    Vec3 candidate;
    for (int halving = 0; halving <= kMaxHalvings; ++halving, length *= 0.5) {
      candidate = place + length * *step;
      next = star.largest_m(candidate, now);
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
  const Vec3 place = minimise(star, iterations);
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
