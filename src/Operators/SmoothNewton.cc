// SPDX-License-Identifier: BSD-3-Clause
// Newton's method on the p-norm of a star; see kernels/newton_step.h. Only + - * / and comparisons are used.
#include "Operators/SmoothNewton.hh"

#include "Operators/Metrics.hh"
#include "Operators/StarForm.hh"

namespace hfr {
namespace {

/// Displacement that lowers the largest m as far as Newton's method on the norm takes it.
Vec3 minimise(const StarForm& star, int iterations) {
  const auto largest = [&](hfr_real3 x, double ceiling) { return star.largest_m(x, ceiling); };
  const auto shares = [&](hfr_real3 x, double m_max) { return star.newton(x, m_max); };
  hfr_real3 place;
  HFR_NEWTON_SEARCH(iterations, largest, shares, place);
  return {place.x, place.y, place.z};
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
