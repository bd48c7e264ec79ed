// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, JPDC 73 (2013), section 3.3: "candidate positions" at radius r round the vertex.
#include "Operators/SmoothCandidates.hh"

#include <algorithm>

#include "Operators/Metrics.hh"
#include "Operators/StarForm.hh"
#include "kernels/candidates.h"

namespace hfr {
namespace {

hfr_section section_of(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link) {
  hfr_section section = hfr_section_zero();
  const Vec3 origin = mesh.point(v);
  for (HalfFaceHandle h : link) {
    const auto f = mesh.halfface_vertices(h);
    for (std::size_t i = 0; i < 3; ++i)
      section = hfr_section_add(section, to_kernel(mesh.point(f[i]) - origin),
                                to_kernel(mesh.point(f[(i + 1) % 3]) - mesh.point(f[i])));
  }
  return section;
}

/// The search proper. ask(candidates, floor, worst): smallest decision value with the vertex moved by each of
/// the candidates; anything ≤ floor will do once none is better.
template <class Ask>
Vec3 ascend(const hfr_section& section, std::size_t n_cells, int halvings, double worst_now, Ask&& ask) {
  FixedVector<Vec3, HFR_CANDIDATE_DIRECTIONS> candidates;
  std::array<double, StarForm::kTrials> values;
  const auto look = [&](hfr_real3 from, double radius, double& best, hfr_real3& next) {
    candidates.clear();
    for (int i = 0; i < HFR_CANDIDATE_DIRECTIONS; ++i) {
      const hfr_real3 x = hfr_candidate(from, radius, i);
      if (hfr_section_contains(section, x)) candidates.push_back({x.x, x.y, x.z});
    }
    ask(candidates, best, values);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!(values[i] > best)) continue;
      best = values[i];
      next = to_kernel(candidates[i]);
    }
  };
  hfr_real3 place;
  HFR_CANDIDATE_SEARCH(halvings, hfr_section_radius(section, static_cast<double>(n_cells)), worst_now, look,
                       place);
  return {place.x, place.y, place.z};
}

/// All candidates at once.
auto ask(StarForm& star) {
  return [&star](const auto& candidates, double floor, StarForm::Trials& worst) {
    StarForm::Trials x, y, z;
    for (std::size_t i = 0; i < StarForm::kTrials && !candidates.empty(); ++i) {
      const Vec3 p = candidates[std::min(i, candidates.size() - 1)];
      x[i] = p.x;
      y[i] = p.y;
      z[i] = p.z;
    }
    if (!candidates.empty()) star.worst(x, y, z, floor, worst);
  };
}

}  // namespace

template <class Metric>
std::optional<Move> CandidateSearch::operator()(const TetMesh& mesh, VertexHandle v,
                                                std::span<const HalfFaceHandle> link, const Metric& metric,
                                                std::span<const double> quality) const {
  Move move;
  move.old_worst = worst_of(link, quality);
  const hfr_section section = section_of(mesh, v, link);
  const Vec3 origin = mesh.point(v);
  Vec3 place;
  if constexpr (std::is_same_v<Metric, VolumeLength>) {
    StarForm star(mesh, v, link);
    place = ascend(section, link.size(), halvings, move.old_worst, ask(star));
  } else {
    place = ascend(section, link.size(), halvings, move.old_worst,
                   [&](const auto& candidates, double floor, StarForm::Trials& worst) {
                     for (std::size_t i = 0; i < candidates.size(); ++i) {
                       worst[i] = worst_with(mesh, v, link, origin + candidates[i], metric, floor);
                       floor = std::max(floor, worst[i]);
                     }
                   });
  }
  if (place == Vec3{}) return std::nullopt;
  move.target = origin + place;
  // What decides is the formula that the cells are judged by, on the rounded position.
  move.new_worst = worst_with(mesh, v, link, move.target, metric, move.old_worst);
  if (!(move.new_worst > move.old_worst)) return std::nullopt;
  return move;
}

HFR_INSTANTIATE_SEARCH(CandidateSearch)

}  // namespace hfr
