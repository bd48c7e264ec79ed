// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, JPDC 73 (2013), section 3.3: "candidate positions" at radius r round the vertex.
#include "Operators/SmoothCandidates.hh"

#include <algorithm>

#include "Operators/Metrics.hh"
#include "Operators/StarForm.hh"

namespace hfr {
namespace {

constexpr double kDiagonal = 0.57735026918962576;  // 1/√3: all directions have length 1

/// The axes, then the diagonals of the cube.
constexpr std::array<Vec3, 14> kDirections = {{{1, 0, 0},
                                               {-1, 0, 0},
                                               {0, 1, 0},
                                               {0, -1, 0},
                                               {0, 0, 1},
                                               {0, 0, -1},
                                               {kDiagonal, kDiagonal, kDiagonal},
                                               {-kDiagonal, kDiagonal, kDiagonal},
                                               {kDiagonal, -kDiagonal, kDiagonal},
                                               {-kDiagonal, -kDiagonal, kDiagonal},
                                               {kDiagonal, kDiagonal, -kDiagonal},
                                               {-kDiagonal, kDiagonal, -kDiagonal},
                                               {kDiagonal, -kDiagonal, -kDiagonal},
                                               {-kDiagonal, -kDiagonal, -kDiagonal}}};

/// Where candidates may lie, relative to the vertex, and at what distance they begin.
struct Section {
  double radius = 0;  ///< half the mean length of the star's edges; an edge counts once a face that it bounds
  Vec3 low, high;     ///< box of the star

  bool contains(Vec3 x) const {
    return x.x >= low.x && x.x <= high.x && x.y >= low.y && x.y <= high.y && x.z >= low.z && x.z <= high.z;
  }
};

Section section_of(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link) {
  Section section;
  const Vec3 origin = mesh.point(v);
  double sum = 0;
  for (HalfFaceHandle h : link) {
    const auto f = mesh.halfface_vertices(h);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 p = mesh.point(f[i]) - origin;
      sum += norm(p) + norm(mesh.point(f[(i + 1) % 3]) - mesh.point(f[i]));
      for (int d = 0; d < 3; ++d) {
        section.low[d] = std::min(section.low[d], p[d]);
        section.high[d] = std::max(section.high[d], p[d]);
      }
    }
  }
  section.radius = 0.5 * sum / (6.0 * static_cast<double>(link.size()));
  return section;
}

/// The search proper. ask(candidates, floor, worst): smallest decision value with the vertex moved by each of
/// the candidates; anything ≤ floor will do once none is better. Candidates stay in the box of the star:
/// outside it no cell can be right, but the quality of an inverted cell may rise on the way to infinity.
template <class Ask>
Vec3 ascend(const Section& section, int halvings, double worst_now, Ask&& ask) {
  Vec3 place;
  double radius = section.radius;
  FixedVector<Vec3, kDirections.size()> candidates;
  std::array<double, StarForm::kTrials> worst;
  for (int level = 0; level < halvings;) {
    candidates.clear();
    for (Vec3 direction : kDirections) {
      const Vec3 candidate = place + radius * direction;
      if (section.contains(candidate)) candidates.push_back(candidate);
    }
    ask(candidates, worst_now, worst);
    double best = worst_now;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!(worst[i] > best)) continue;
      best = worst[i];
      place = candidates[i];
    }
    if (best > worst_now) {
      worst_now = best;
    } else {
      radius *= 0.5;
      ++level;
    }
  }
  return place;
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
  const Section section = section_of(mesh, v, link);
  const Vec3 origin = mesh.point(v);
  Vec3 place;
  if constexpr (std::is_same_v<Metric, VolumeLength>) {
    StarForm star(mesh, v, link);
    place = ascend(section, halvings, move.old_worst, ask(star));
  } else {
    place = ascend(section, halvings, move.old_worst,
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
