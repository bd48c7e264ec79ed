// SPDX-License-Identifier: BSD-3-Clause
// Freitag & Ollivier-Gooch, Tetrahedral mesh improvement using swapping and smoothing, 1997.
#include "Operators/SmoothMaxMin.hh"

#include "Operators/MaxMinForm.hh"
#include "Operators/Metrics.hh"

namespace hfr {

template <class Metric>
std::optional<Move> MaxMinSearch::operator()(const TetMesh& mesh, VertexHandle v,
                                             std::span<const HalfFaceHandle> link, const Metric& metric,
                                             std::span<const double> quality) const {
  if constexpr (!std::is_same_v<Metric, MinSine2> && !std::is_same_v<Metric, MinDihedral>) {
    return fallback(mesh, v, link, metric, quality);
  } else {
    Move move;
    move.old_worst = worst_of(link, quality);
    if (!(move.old_worst > 0)) return fallback(mesh, v, link, metric, quality);
    const Vec3 origin = mesh.point(v);
    MaxMinForm form(origin, MaxMinForm::kAnglesOf<Metric>);
    for (HalfFaceHandle h : link) {
      const auto f = mesh.halfface_vertices(h);
      form.add(mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2]));
    }
    move.target = form.ascend(origin, iterations);
    if (move.target == origin) return std::nullopt;
    // What decides is the formula that the cells are judged by, on the rounded position.
    move.new_worst = worst_with(mesh, v, link, move.target, metric, move.old_worst);
    if (!(move.new_worst > move.old_worst)) return std::nullopt;
    return move;
  }
}

HFR_INSTANTIATE_SEARCH(MaxMinSearch)

}  // namespace hfr
