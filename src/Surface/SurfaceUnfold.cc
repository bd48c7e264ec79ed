// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceUnfold.hh"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "Surface/Features.hh"
#include "Surface/InputSurface.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {
namespace {

using surface::Arrays;
using surface::corners;
using surface::scaled_normal;
using surface::unit;

constexpr int kRings = 6;  // round folded faces that take part
constexpr int kSight = 4;  // rings that are known to be about as wide as folds
constexpr int kPasses = 300;
constexpr int kPatience = 60;  // passes without fewer folds
/// A face is folded over when its normal is turned by more than this (cosine) against the area vector of what
/// lies round it, and that vector is not the small sum of faces of opposite sides, as at a thin edge.
constexpr double kAgainst = -0.2;
constexpr double kOneSided = 0.2;
/// Share of the distance allowed that unfolding may use up.
constexpr double kShare = 0.8;

/// Which faces use a vertex.
class Stars {
 public:
  explicit Stars(const Arrays& arrays) : first_(arrays.points.size() + 1, 0) {
    for (const auto& f : arrays.faces)
      for (VertexHandle v : f) ++first_[v.idx() + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    faces_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < arrays.faces.size(); ++i)
      for (VertexHandle v : arrays.faces[i]) faces_[next[v.idx()]++] = static_cast<std::uint32_t>(i);
  }
  std::span<const std::uint32_t> at(VertexHandle v) const {
    return {faces_.data() + first_[v.idx()], first_[v.idx() + 1] - first_[v.idx()]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> faces_;
};

/// The surface of one call, whose points are its own.
class Unfolder {
 public:
  Unfolder(const Arrays& arrays, const SurfaceOptions& options)
      : arrays_(arrays), options_(options), stars_(arrays) {
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

  /// Vertices to spread: those of folded faces and some rings round them, if nothing holds them.
  std::vector<VertexHandle> region(const std::vector<std::uint8_t>& folds) const {
    std::vector<std::uint8_t> in(points_.size(), 0), near(arrays_.faces.size(), 0);
    for (std::size_t i = 0; i < folds.size(); ++i)
      if (folds[i])
        for (VertexHandle v : arrays_.faces[i]) in[v.idx()] = 1;
    for (int ring = 0; ring < kRings; ++ring) {
      for (std::size_t i = 0; i < arrays_.faces.size(); ++i)
        for (VertexHandle v : arrays_.faces[i]) near[i] = near[i] || in[v.idx()];
      for (std::size_t i = 0; i < arrays_.faces.size(); ++i)
        if (near[i])
          for (VertexHandle v : arrays_.faces[i]) in[v.idx()] = 1;
    }
    const std::vector<std::uint8_t> held = held_vertices(folds);
    std::vector<VertexHandle> vertices;
    for (std::size_t v = 0; v < in.size(); ++v)
      if (in[v] && !held[v]) vertices.push_back(VertexHandle(v));
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
  void set(std::vector<Vec3> points) { points_ = std::move(points); }

 private:
  std::vector<Vec3> normals() const {  // as long as twice the areas
    std::vector<Vec3> all;
    for (const auto& f : arrays_.faces) all.push_back(scaled_normal(corners(points_, f)));
    return all;
  }
  /// Fixed ones, and those on features other than edges of folded faces.
  std::vector<std::uint8_t> held_vertices(const std::vector<std::uint8_t>& folds) const {
    std::vector<std::uint8_t> held(points_.size(), 0);
    for (VertexHandle v : arrays_.locked_vertices) held[v.idx()] = 1;
    for (const auto& e : arrays_.locked_edges)
      for (VertexHandle v : e) held[v.idx()] = 1;
    for (std::size_t i = 0; i < arrays_.faces.size(); ++i)
      if (arrays_.locked[i] || arrays_.interface[i])
        for (VertexHandle v : arrays_.faces[i]) held[v.idx()] = 1;
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
    const double cosine = std::cos(0.5 * options_.feature_angle * (std::numbers::pi / 180.0));
    for (const surface::Edge& e : surface::find_features(arrays_, turning, 0).edges) {
      if (!e.feature) continue;
      if (e.manifold && !e.locked && arrays_.patch[e.f[0]] == arrays_.patch[e.f[1]]) {
        const VertexHandle c = arrays_.faces[e.f[0]][(e.k[0] + 2U) % 3];
        const VertexHandle d = arrays_.faces[e.f[1]][(e.k[1] + 2U) % 3];
        if (at_fold[e.a.idx()] || at_fold[e.b.idx()] || at_fold[c.idx()] || at_fold[d.idx()]) continue;
        if (dot(unit(round[c.idx()]), unit(round[d.idx()])) > cosine) continue;
      }
      held[e.a.idx()] = held[e.b.idx()] = 1;
    }
    return held;
  }

  const Arrays& arrays_;
  const SurfaceOptions& options_;
  Stars stars_;
  std::vector<Vec3> points_;
};

std::vector<Triangle> triangles(const Arrays& arrays, std::span<const Vec3> points) {
  std::vector<Triangle> all;
  for (const auto& f : arrays.faces) all.push_back(corners(points, f));
  return all;
}

/// The new points of the vertices, or nothing.
std::optional<std::vector<Vec3>> unfold(const Arrays& arrays, const SurfaceOptions& options,
                                        par::Policy policy, Unfolding& done) {
  constexpr double kSpacing = 0.25;
  constexpr double kCoplanar = 1e-12;  // of the mean edge: what flat mode allows
  if (options.mode == SurfaceMode::kFrozen || arrays.faces.empty()) return std::nullopt;
  Unfolder unfolder(arrays, options);
  const std::vector<std::uint8_t> folds = unfolder.folded(done.n_folded);
  done.n_left = done.n_folded;
  if (done.n_folded == 0) return std::nullopt;
  const std::vector<VertexHandle> vertices = unfolder.region(folds);
  const std::vector<Triangle> before = triangles(arrays, arrays.points);
  const InputSurface shape(before);
  std::vector<Vec3> best;
  int idle = 0;
  for (int pass = 0; pass < kPasses && done.n_left > 0 && idle < kPatience; ++pass) {
    unfolder.spread(vertices, shape);
    std::size_t n = 0;
    unfolder.folded(n);
    ++idle;
    if (n >= done.n_left) continue;
    done.n_left = n;
    best = unfolder.points();
    idle = 0;
  }
  if (best.empty()) return std::nullopt;
  const double edge = surface::mean_edge(arrays);
  const double bound = options.mode == SurfaceMode::kFlat
                           ? kCoplanar * edge
                           : kShare * surface::allowed_distance(arrays, options);
  const SurfaceDistance moved = surface_distance(before, triangles(arrays, best), kSpacing * edge, policy);
  if (!(moved.hausdorff() <= bound)) {
    done.n_left = done.n_folded;
    return std::nullopt;
  }
  done.distance = moved.hausdorff();
  for (VertexHandle v : vertices)
    if (best[v.idx()] != arrays.points[v.idx()]) ++done.n_moved;
  return best;
}

}  // namespace

Unfolding unfold_surface(TetMesh& mesh, const SurfaceOptions& options, par::Policy policy) {
  Unfolding done;
  const auto points = unfold(surface::gather(mesh, options, policy), options, policy, done);
  if (!points) return done;
  for (VertexHandle v : mesh.vertices())
    if ((*points)[v.idx()] != mesh.point(v)) mesh.set_point(v, (*points)[v.idx()]);
  return done;
}

}  // namespace hfr
