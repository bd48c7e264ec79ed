// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceUnfold.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "HalfFace/Layers.hh"
#include "Surface/FaceStars.hh"
#include "Surface/Features.hh"
#include "Surface/InputSurface.hh"
#include "Surface/SurfaceLayers.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {
namespace {

using surface::Arrays;
using surface::corners;
using surface::FaceStars;
using surface::scaled_normal;
using surface::SurfaceLayers;
using surface::unit;

constexpr int kRings = 6;  // rings of faces round folded ones that take part
constexpr int kSight = 4;  // rings of faces by which it is told whether a face is folded
/// Rings of faces that take part round all that a wide fold covers: one number after the other is tried,
/// until the distance is small enough.
constexpr std::array<int, 5> kRingsOfCovered = {2, 1, 3, 4, 6};
constexpr int kRingsAtOnce = 24;  // rings that a fold is looked for in
constexpr int kPasses = 300;      // of spreading, at most
constexpr int kPatience = 60;     // passes without fewer folds
/// A face is folded over when its normal is turned by more than this (cosine) against the area vector of what
/// lies round it, and that vector is not the small sum of faces of opposite sides, as at a thin edge.
constexpr double kAgainst = -0.2;
constexpr double kOneSided = 0.2;
/// Share of the distance allowed that unfolding may use up.
constexpr double kShare = 0.8;

/// The surface of one call, whose points are its own.
class Unfolder {
 public:
  Unfolder(const Arrays& arrays, const SurfaceOptions& options)
      : arrays_(arrays), options_(options), stars_(arrays), reach_(surface::mean_edge(arrays)) {
    points_.assign(arrays.points.begin(), arrays.points.end());
  }

  const std::vector<Vec3>& points() const { return points_; }

  /// Faces against what lies round them, as flags; `n` counts them.
  std::vector<std::uint8_t> folded(std::size_t& n) const {
    const std::vector<Vec3> normal = normals();
    std::vector<Vec3> round(points_.size());
    std::vector<double> area(points_.size(), 0);
    for (std::size_t i = 0; i < normal.size(); ++i)
      for (VertexHandle v : arrays_.faces[i]) {
        round[v.idx()] = round[v.idx()] + normal[i];
        area[v.idx()] += norm(normal[i]);
      }
    for (int pass = 0; pass < kSight; ++pass) {
      const std::vector<Vec3> old = round;
      const std::vector<double> old_area = area;
      for (const auto& f : arrays_.faces)
        for (std::size_t k = 0; k < 3; ++k) {
          round[f[k].idx()] = round[f[k].idx()] + old[f[(k + 1) % 3].idx()];
          area[f[k].idx()] += old_area[f[(k + 1) % 3].idx()];
        }
    }
    std::vector<std::uint8_t> flags(normal.size(), 0);
    n = 0;
    for (std::size_t i = 0; i < normal.size(); ++i) {
      const auto& f = arrays_.faces[i];
      const Vec3 sum = round[f[0].idx()] + round[f[1].idx()] + round[f[2].idx()];
      const double total = area[f[0].idx()] + area[f[1].idx()] + area[f[2].idx()];
      const double length = norm(sum);
      if (!(length > kOneSided * total)) continue;
      if (!(dot(normal[i], sum) < kAgainst * norm(normal[i]) * length)) continue;
      flags[i] = 1;
      ++n;
    }
    return flags;
  }

  /// What rings of faces do not see of wide folds: takes in what hangs together with the flagged faces and is
  /// against all layers near to it. Returns how many faces that are.
  std::size_t grow(std::vector<std::uint8_t>& folds) const {
    std::size_t all = 0;
    for (std::size_t n = 1; n > 0; all += n)
      n = take_in(folds, [](const SurfaceLayers& layers, const Triangle& t) { return layers.against(t); });
    return all;
  }
  /// The flagged faces with all that lies on or under them.
  std::vector<std::uint8_t> covered(std::vector<std::uint8_t> folds) const {
    const auto several = [](const SurfaceLayers& layers, const Triangle& t) { return layers.covered(t); };
    while (take_in(folds, several) > 0) {
    }
    return folds;
  }
  /// How many of the faces are against all layers near to them.
  std::size_t n_against(std::span<const std::uint32_t> faces) const {
    const SurfaceLayers layers(arrays_, points_, reach_, faces);
    return static_cast<std::size_t>(std::count_if(faces.begin(), faces.end(), [&](std::uint32_t f) {
      return layers.against(corners(points_, arrays_.faces[f]));
    }));
  }
  /// Faces at the vertices, ascending.
  std::vector<std::uint32_t> faces_at(const std::vector<VertexHandle>& vertices) const {
    std::vector<std::uint32_t> faces;
    for (VertexHandle v : vertices) faces.insert(faces.end(), stars_.at(v).begin(), stars_.at(v).end());
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
  }

  /// Vertices to spread: those of flagged faces and some rings round them, if nothing holds them. In a wide
  /// fold what turns between two sides of which all layers together do not is no feature.
  std::vector<VertexHandle> region(const std::vector<std::uint8_t>& folds, int rings, bool wide) const {
    const std::vector<VertexHandle> in = vertices_round(folds, rings);
    const std::vector<std::uint8_t> held = held_vertices(folds, wide ? faces_at(in) : Faces{});
    std::vector<VertexHandle> vertices;
    std::copy_if(in.begin(), in.end(), std::back_inserter(vertices),
                 [&](VertexHandle v) { return !held[v.idx()]; });
    return vertices;
  }

  /// Every vertex to the mean of its neighbours, and from there back onto the surface.
  void spread(const std::vector<VertexHandle>& vertices, const InputSurface& shape) {
    for (VertexHandle v : vertices) {
      Vec3 sum;
      double n = 0;
      for (std::uint32_t f : stars_.at(v))
        for (VertexHandle w : arrays_.faces[f]) {
          if (w == v) continue;
          sum = sum + points_[w.idx()];
          n += 1;
        }
      points_[v.idx()] = shape.nearest((1 / n) * sum).point;
    }
  }

 private:
  using Faces = std::vector<std::uint32_t>;

  /// Vertices of the flagged faces and of so many rings round them, ascending.
  std::vector<VertexHandle> vertices_round(const std::vector<std::uint8_t>& folds, int rings) const {
    std::vector<std::uint8_t> in(points_.size(), 0);
    std::vector<VertexHandle> vertices;
    const auto enter = [&](VertexHandle v) { return std::exchange(in[v.idx()], std::uint8_t{1}) == 0; };
    for (std::size_t i = 0; i < folds.size(); ++i)
      if (folds[i])
        for (VertexHandle v : arrays_.faces[i])
          if (enter(v)) vertices.push_back(v);
    const auto around = [&](std::span<const VertexHandle> rim, auto&& reach) {
      for (VertexHandle v : rim)
        for (std::uint32_t f : stars_.at(v))
          for (VertexHandle w : arrays_.faces[f]) reach(w);
    };
    grow_layers(vertices, rings, around, enter);
    std::sort(vertices.begin(), vertices.end());
    return vertices;
  }
  /// Flags the faces for which kind(layers, triangle) holds and that a walk from flagged ones over such faces
  /// comes to within some rings.
  template <class Kind>
  std::size_t take_in(std::vector<std::uint8_t>& folds, Kind&& kind) const {
    const Faces near = faces_at(vertices_round(folds, kRingsAtOnce));
    const SurfaceLayers layers(arrays_, points_, reach_, near);
    std::vector<std::uint8_t> asked(arrays_.faces.size(), 1);
    for (std::uint32_t f : near) asked[f] = folds[f];
    Faces faces;
    for (std::uint32_t f : near)
      if (folds[f]) faces.push_back(f);
    const std::size_t n_before = faces.size();
    const auto around = [&](std::span<const std::uint32_t> rim, auto&& reach) {
      for (std::uint32_t i : rim)
        for (VertexHandle v : arrays_.faces[i])
          for (std::uint32_t f : stars_.at(v)) reach(f);
    };
    grow_layers(faces, kAllLayers, around, [&](std::uint32_t f) {
      if (asked[f]) return false;
      asked[f] = 1;
      if (kind(layers, corners(points_, arrays_.faces[f]))) folds[f] = 1;
      return folds[f] != 0;
    });
    return faces.size() - n_before;
  }
  std::vector<Vec3> normals() const {  // as long as twice the areas
    std::vector<Vec3> all;
    for (const auto& f : arrays_.faces) all.push_back(scaled_normal(corners(points_, f)));
    return all;
  }
  /// Vertices that stay: fixed ones, and those on features other than edges of folded faces. `layered`: faces
  /// at whose edges all layers count.
  std::vector<std::uint8_t> held_vertices(const std::vector<std::uint8_t>& folds,
                                          const Faces& layered) const {
    std::vector<std::uint8_t> held = surface::held_vertices(arrays_);
    SurfaceOptions turning = options_;
    turning.mode = SurfaceMode::kFree;  // facets of flat mode end at folds
    // Slivers and whole stars at a fold turn any way; a feature is an edge whose two sides differ as well.
    std::vector<std::uint8_t> at_fold(points_.size(), 0);
    std::vector<Vec3> round(points_.size());
    const std::vector<Vec3> normal = normals();
    for (std::size_t i = 0; i < arrays_.faces.size(); ++i)
      for (VertexHandle v : arrays_.faces[i]) {
        at_fold[v.idx()] = at_fold[v.idx()] || folds[i];
        round[v.idx()] = round[v.idx()] + normal[i];
      }
    const double radians = options_.feature_angle * (std::numbers::pi / 180.0);
    const SurfaceLayers layers(arrays_, points_, reach_, layered);
    // As far from the edge as layers reach: the far corners of long triangles lie round the next bend.
    const auto beside = [&](Vec3 on_edge, VertexHandle v) {
      const Vec3 to = points_[v.idx()] - on_edge;
      return layers.outward(on_edge + std::min(1.0, reach_ / norm(to)) * to);
    };
    const auto turns = [&](const surface::Edge& e, VertexHandle c, VertexHandle d) {
      if (layered.empty())
        return !(dot(unit(round[c.idx()]), unit(round[d.idx()])) > std::cos(0.5 * radians));
      const Vec3 on_edge = 0.5 * (points_[e.a.idx()] + points_[e.b.idx()]);
      return !(dot(beside(on_edge, c), beside(on_edge, d)) > std::cos(radians));
    };
    for (const surface::Edge& e : surface::find_features(arrays_, turning, 0).edges) {
      if (!e.feature) continue;
      if (e.manifold && !e.locked && arrays_.patch[e.f[0]] == arrays_.patch[e.f[1]]) {
        const VertexHandle c = arrays_.faces[e.f[0]][(e.k[0] + 2U) % 3];
        const VertexHandle d = arrays_.faces[e.f[1]][(e.k[1] + 2U) % 3];
        if (at_fold[e.a.idx()] || at_fold[e.b.idx()] || at_fold[c.idx()] || at_fold[d.idx()]) continue;
        if (!turns(e, c, d)) continue;
      }
      held[e.a.idx()] = held[e.b.idx()] = 1;
    }
    return held;
  }

  const Arrays& arrays_;
  const SurfaceOptions& options_;
  FaceStars stars_;
  double reach_;  // of layers
  std::vector<Vec3> points_;
};

std::vector<Triangle> triangles(const Arrays& arrays, std::span<const Vec3> points) {
  std::vector<Triangle> all;
  for (const auto& f : arrays.faces) all.push_back(corners(points, f));
  return all;
}

/// What one way to unfold comes to.
struct Attempt {
  std::vector<Vec3> points;  ///< empty: no fewer folds
  std::size_t n_left = 0;
  double distance = 0;
  std::vector<VertexHandle> vertices;
};

/// The surface as it was, the shape to keep, and ways to unfold it.
class Attempts {
 public:
  Attempts(const Arrays& arrays, const SurfaceOptions& options, par::Policy policy,
           const std::function<bool()>& stopped)
      : arrays_(arrays),
        options_(options),
        policy_(policy),
        stopped_(stopped),
        before_(triangles(arrays, arrays.points)),
        shape_(before_) {}

  bool stopped() const { return stopped_ && stopped_(); }
  /// Spreads the vertices round the flagged faces. `wide`: folds are counted by faces that are against all
  /// layers near to them.
  Attempt spread(const std::vector<std::uint8_t>& flagged, std::size_t n_folded, int rings, bool wide) const {
    constexpr double kSpacing = 0.25;
    Unfolder unfolder(arrays_, options_);
    Attempt attempt{.points = {}, .n_left = n_folded, .vertices = unfolder.region(flagged, rings, wide)};
    const std::vector<std::uint32_t> faces = unfolder.faces_at(attempt.vertices);
    int idle = 0;
    for (int pass = 0; pass < kPasses && attempt.n_left > 0 && idle < kPatience && !stopped(); ++pass) {
      unfolder.spread(attempt.vertices, shape_);
      std::size_t n = 0;
      if (wide)
        n = unfolder.n_against(faces);
      else
        unfolder.folded(n);
      ++idle;
      if (n >= attempt.n_left) continue;
      attempt.n_left = n;
      attempt.points = unfolder.points();
      idle = 0;
    }
    if (!attempt.points.empty())
      attempt.distance = surface_distance(before_, triangles(arrays_, attempt.points),
                                          kSpacing * surface::mean_edge(arrays_), policy_)
                             .hausdorff();
    return attempt;
  }

 private:
  const Arrays& arrays_;
  const SurfaceOptions& options_;
  par::Policy policy_;
  const std::function<bool()>& stopped_;
  std::vector<Triangle> before_;
  InputSurface shape_;
};

}  // namespace

std::optional<std::vector<Vec3>> unfold(const Arrays& arrays, const SurfaceOptions& options,
                                        par::Policy policy, const std::function<bool()>& stopped,
                                        SurfaceUnfolding& done) {
  constexpr double kCoplanar = 1e-12;  // of the mean edge: what flat mode allows
  if (options.mode == SurfaceMode::kFrozen || arrays.faces.empty()) return std::nullopt;
  const Unfolder unfolder(arrays, options);
  std::vector<std::uint8_t> folds = unfolder.folded(done.n_folded);
  done.n_left = done.n_folded;
  if (done.n_folded == 0) return std::nullopt;
  const double bound = options.mode == SurfaceMode::kFlat
                           ? kCoplanar * surface::mean_edge(arrays)
                           : kShare * surface::allowed_distance(arrays, options);
  const Attempts attempts(arrays, options, policy, stopped);
  const auto fits = [&](const Attempt& a) { return !a.points.empty() && a.distance <= bound; };
  std::vector<std::uint8_t> flagged = folds;
  done.n_folded += unfolder.grow(flagged);
  Attempt best;
  if (done.n_folded == done.n_left) best = attempts.spread(folds, done.n_folded, kRings, false);
  double least = std::numeric_limits<double>::infinity();  // distance that unfolding takes
  if (!fits(best) || best.n_left > 0) {
    const std::vector<std::uint8_t> covered = unfolder.covered(flagged);
    for (int rings : kRingsOfCovered) {
      if (attempts.stopped()) break;
      Attempt next = attempts.spread(covered, done.n_folded, rings, true);
      if (!next.points.empty() && next.n_left == 0) least = std::min(least, next.distance);
      if (!fits(next) || (fits(best) && best.n_left <= next.n_left)) continue;
      best = std::move(next);
      if (best.n_left == 0) break;
    }
  }
  if (!fits(best)) {
    done.n_left = done.n_folded;
    if (options.mode == SurfaceMode::kFree && std::isfinite(least)) done.needs = least / kShare;
    return std::nullopt;
  }
  done.n_left = best.n_left;
  done.distance = best.distance;
  for (VertexHandle v : best.vertices)
    if (best.points[v.idx()] != arrays.points[v.idx()]) ++done.n_moved;
  return best.points;
}

SurfaceUnfolding unfold_surface(TetMesh& mesh, const SurfaceOptions& options, par::Policy policy,
                                const std::function<bool()>& stopped) {
  SurfaceUnfolding done;
  const auto points = unfold(surface::gather(mesh, options, policy), options, policy, stopped, done);
  if (!points) return done;
  for (VertexHandle v : mesh.vertices())
    if ((*points)[v.idx()] != mesh.point(v)) mesh.set_point(v, (*points)[v.idx()]);
  return done;
}

}  // namespace hfr
