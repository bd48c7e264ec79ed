// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, JPDC 73 (2013), section 7: "This scheme has already been successfully applied to surface
// meshes composed of triangles." A cluster is the pair at an edge, the star of a vertex, or a cavity.
#include "Surface/TriangleSweep.hh"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "Quality/Metrics.hh"
#include "Surface/Features.hh"
#include "Surface/TangentSearch.hh"
#include "kernels/triangle.h"

namespace hfr {

using surface::normal_to;
using surface::scaled_normal;
using surface::search_places_by_halving;
using surface::TangentSteps;
using surface::unit;

namespace {

constexpr int kHalvings = 5;
constexpr std::size_t kMaxPolygon = 12;
/// By what a new vertex must raise the worst decision value of its cavity: it costs two triangles.
constexpr double kSplitGain = 1.1;

/// Steps from `place` by `radius` in the free directions to where value(x) is larger, the radius halved when
/// none is. `value` may give up once it is no larger than its second argument.
template <class Value, class Project>
Vec3 climb(Vec3 place, double radius, Vec3 axis, bool on_line, Project&& project, Value&& value) {
  double best = value(place, -1.0);
  const TangentSteps steps =
      on_line ? TangentSteps::on_line(axis) : TangentSteps::in_plane(axis, unit(normal_to(axis)));
  const auto consider = [&](Vec3 x) {
    const Vec3 candidate = project(x);
    const double now = value(candidate, best);
    if (!(now > best)) return false;
    best = now;
    place = candidate;
    return true;
  };
  search_places_by_halving(
      radius, kHalvings, [&](double r) { return steps.at(r, place); }, consider);
  return place;
}

}  // namespace

double triangle_decision(const Triangle& t) {
  return hfr_triangle_min_sin2(to_real3(t[0]), to_real3(t[1]), to_real3(t[2]));
}

/// The faces round a vertex, and where it stands in each.
struct TriangleSweep::Star {
  std::vector<Face> faces;
  std::vector<Triangle> removed;
  std::vector<std::size_t> corner;
  double worst = std::numeric_limits<double>::infinity();
  double mean_edge = 0;
  Vec3 normal;  // of length 1; zero when there is none
  /// By face, of those that no feature parts from it: they look about the same way, at a sharp edge no others
  /// do.
  std::vector<Vec3> outside;

  bool turns_over(std::size_t i, const Triangle& t) const { return !(dot(scaled_normal(t), outside[i]) > 0); }

  std::vector<Triangle> moved_to(Vec3 x) const {
    std::vector<Triangle> created = removed;
    for (std::size_t i = 0; i < created.size(); ++i) created[i][corner[i]] = x;
    return created;
  }
  double worst_with(Vec3 x, double floor) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < removed.size() && least > floor; ++i) {
      Triangle t = removed[i];
      t[corner[i]] = x;
      // A triangle that turns over is none.
      least = std::min(least, turns_over(i, t) ? 0.0 : triangle_decision(t));
    }
    return least;
  }
  bool is_flat() const {
    constexpr double kLevel = 1.0 - 1e-9;
    return std::all_of(removed.begin(), removed.end(), [&](const Triangle& t) {
      const Vec3 n = scaled_normal(t);
      return dot(n, normal) >= kLevel * norm(n);
    });
  }
};

/// A polygon of the surface, seen from outside; open (an edge is missing from its last to its first corner)
/// where the split edge is on the rim.
struct TriangleSweep::Insertion {
  std::vector<VertexHandle> polygon;
  bool closed = true;
  std::vector<Face> faces;                                 // that the polygon is made of
  std::vector<std::array<VertexHandle, 2>> flips;          // edges across which it has grown, in order
  double worst = std::numeric_limits<double>::infinity();  // of the faces
  Vec3 axis;  // normal to the plane, or along the line, in which the new vertex stays
  bool on_line = false;
  Vec3 anchor, middle;
  double size = 0;
  std::size_t weakest = 0;  // corner before the edge of the worst new triangle
  double worst_new = 0;

  std::size_t n_edges() const { return polygon.size() - (closed ? 0 : 1); }
};

// Also of vertices that no face has: new ones come behind them.
TriangleSweep::TriangleSweep(SurfaceMesh& surface) : surface_(surface), points_(surface.n_points()) {
  for (std::size_t f = 0; f < surface.n_faces(); ++f)
    for (VertexHandle v : surface.face_vertices(f)) points_[v.idx()] = surface.point(v);
  changed_.assign(points_.size(), clock_);
}

void TriangleSweep::focus(double below) {
  below_ = below;
  looked_.fill(0);
}

std::size_t TriangleSweep::n_below() const {
  std::size_t n = 0;
  for (std::size_t f = 0; f < surface_.n_faces(); ++f)
    if (!surface_.is_deleted(f) && decision(surface_.face_vertices(f)) < below_) ++n;
  return n;
}

double TriangleSweep::worst() const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < surface_.n_faces(); ++f)
    if (!surface_.is_deleted(f)) least = std::min(least, decision(surface_.face_vertices(f)));
  return least;
}

bool TriangleSweep::changed_since(const Face& f, std::uint32_t since) const {
  return changed_[f[0].idx()] > since || changed_[f[1].idx()] > since || changed_[f[2].idx()] > since;
}

void TriangleSweep::touch(VertexHandle v) { changed_[v.idx()] = clock_; }

auto TriangleSweep::look(Kind kind) -> std::vector<Face> {
  const std::uint32_t since = looked_[kind];
  looked_[kind] = clock_++;
  std::vector<Face> faces;
  for (std::size_t f = 0; f < surface_.n_faces(); ++f) {
    if (surface_.is_deleted(f)) continue;
    const Face face = surface_.face_vertices(f);
    if (changed_since(face, since) && decision(face) < below_) faces.push_back(face);
  }
  return faces;
}

auto TriangleSweep::free_vertices(const std::vector<Face>& faces) -> std::vector<VertexHandle> {
  std::vector<std::uint8_t> seen(points_.size(), 0);
  std::vector<VertexHandle> vertices;
  for (const Face& f : faces) {
    for (VertexHandle v : f) {
      const SurfaceKind kind = surface_.motion_constraint(v).kind;
      if (seen[v.idx()] || (kind != SurfaceKind::kFacet && kind != SurfaceKind::kCurve)) continue;
      seen[v.idx()] = 1;
      vertices.push_back(v);
    }
  }
  return vertices;
}

bool TriangleSweep::still_there(const Face& f) const {
  for (VertexHandle apex : surface_.across(f[0], f[1]))
    if (apex == f[2]) return true;
  return false;
}

bool TriangleSweep::gather(VertexHandle v, Star& star) const {
  surface_.star(v, star.faces);
  if (star.faces.empty()) return false;
  Vec3 sum;
  double length = 0;
  for (const Face& f : star.faces) {
    const Triangle t = corners(f);
    star.removed.push_back(t);
    star.corner.push_back(f[0] == v ? 0 : f[1] == v ? 1 : 2);
    star.worst = std::min(star.worst, triangle_decision(t));
    sum = sum + scaled_normal(t);
    for (std::size_t k = 0; k < 3; ++k) length += k == star.corner.back() ? 0.0 : norm(t[k] - point(v));
  }
  star.normal = unit(sum);
  if (!find_outside(v, sum, star)) return false;
  star.mean_edge = length / (2.0 * static_cast<double>(star.faces.size()));
  return star.normal != Vec3{};
}

/// False at an edge of more than two sheets, which stays.
bool TriangleSweep::find_outside(VertexHandle v, Vec3 sum, Star& star) const {
  star.outside.assign(star.faces.size(), sum);
  if (surface_.motion_constraint(v).kind != SurfaceKind::kCurve) return true;
  const auto next = [&](const Face& f) { return f[0] == v ? f[1] : f[1] == v ? f[2] : f[0]; };
  const auto previous = [&](const Face& f) { return f[0] == v ? f[2] : f[1] == v ? f[0] : f[1]; };
  std::vector<std::pair<VertexHandle, std::size_t>> behind;  // faces by the vertex before v
  for (std::size_t i = 0; i < star.faces.size(); ++i) behind.emplace_back(previous(star.faces[i]), i);
  std::sort(behind.begin(), behind.end());
  std::vector<std::size_t> side(star.faces.size());  // a face of it that comes earlier, or itself
  std::iota(side.begin(), side.end(), std::size_t{0});
  const auto first_of = [&](std::size_t i) {
    while (side[i] != i) i = side[i] = side[side[i]];
    return i;
  };
  for (std::size_t i = 0; i < side.size(); ++i) {
    const VertexHandle w = next(star.faces[i]);
    if (surface_.is_feature(v, w)) continue;
    for (auto at = std::lower_bound(behind.begin(), behind.end(), std::pair(w, std::size_t{0}));
         at != behind.end() && at->first == w; ++at) {
      const std::size_t a = first_of(i), b = first_of(at->second);
      side[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<Vec3> sums(side.size());
  for (std::size_t i = 0; i < side.size(); ++i) {
    side[i] = first_of(i);
    sums[side[i]] = sums[side[i]] + scaled_normal(star.removed[i]);
  }
  std::size_t n_sides = 0;
  for (std::size_t i = 0; i < side.size(); ++i) {
    star.outside[i] = sums[side[i]];
    n_sides += side[i] == i ? 1 : 0;
  }
  return n_sides <= 2;
}

std::size_t TriangleSweep::swap() {
  std::size_t n = 0;
  for (const Face& f : look(kSwap))
    for (std::size_t k = 0; k < 3; ++k)
      if (try_swap(f[k], f[(k + 1) % 3])) {
        ++n;
        break;  // the face is no more
      }
  return n;
}

bool TriangleSweep::try_swap(VertexHandle a, VertexHandle b) {
  const auto [c, d] = surface_.across(a, b);
  if (!c.is_valid() || !d.is_valid()) return false;
  const std::array<Face, 2> faces = {{{a, b, c}, {b, a, d}}};
  const std::array<Triangle, 2> removed = {corners(faces[0]), corners(faces[1])};
  const std::array<Triangle, 2> created = {corners({c, d, b}), corners({d, c, a})};
  const double worst = std::min(triangle_decision(removed[0]), triangle_decision(removed[1]));
  if (!(triangle_decision(created[0]) > worst) || !(triangle_decision(created[1]) > worst)) return false;
  // Both ways the quadrilateral has the same sum. One that is not convex has a triangle that looks back.
  const Vec3 outside = scaled_normal(removed[0]) + scaled_normal(removed[1]);
  const auto looks_back = [&](const Triangle& t) { return !(dot(scaled_normal(t), outside) > 0); };
  if (std::ranges::any_of(created, looks_back) && std::ranges::none_of(removed, looks_back)) return false;
  if (!surface_.may_swap(a, b) || !surface_.keeps_shape(faces, removed, created)) return false;
  surface_.on_swap(a, b);
  for (VertexHandle v : {a, b, c, d}) touch(v);
  return true;
}

std::size_t TriangleSweep::collapse() {
  std::size_t n = 0;
  for (VertexHandle v : free_vertices(look(kCollapse)))
    if (try_collapse(v)) ++n;
  return n;
}

bool TriangleSweep::try_collapse(VertexHandle v) {
  std::vector<VertexHandle> targets;
  surface_.collapse_targets(v, targets);
  if (targets.empty()) return false;
  Star star;
  if (!gather(v, star)) return false;
  // Best first; the first whose shape is right is taken.
  std::vector<std::pair<double, VertexHandle>> ranked;
  bool turns_over = false;  // a triangle that does not do so already
  const auto without = [&](VertexHandle onto) {
    std::vector<Triangle> created;
    turns_over = false;
    for (std::size_t i = 0; i < star.faces.size(); ++i) {
      const Face& f = star.faces[i];
      if (f[0] == onto || f[1] == onto || f[2] == onto) continue;
      created.push_back(star.removed[i]);
      created.back()[star.corner[i]] = point(onto);
      turns_over = turns_over || (star.turns_over(i, created.back()) && !star.turns_over(i, star.removed[i]));
    }
    return created;
  };
  for (VertexHandle onto : targets) {
    double worst = std::numeric_limits<double>::infinity();
    for (const Triangle& t : without(onto)) worst = std::min(worst, triangle_decision(t));
    if (turns_over) continue;
    if (worst > star.worst && worst < std::numeric_limits<double>::infinity())
      ranked.emplace_back(worst, onto);
  }
  std::sort(ranked.begin(), ranked.end(), [](const auto& x, const auto& y) {
    return x.first != y.first ? x.first > y.first : x.second < y.second;
  });
  for (const auto& [worst, onto] : ranked) {
    if (!surface_.keeps_shape(star.faces, star.removed, without(onto))) continue;
    surface_.on_collapse(v, onto);
    for (const Face& f : star.faces)
      for (VertexHandle w : f) touch(w);
    return true;
  }
  return false;
}

std::size_t TriangleSweep::smooth() {
  std::size_t n = 0;
  for (VertexHandle v : free_vertices(look(kSmooth)))
    if (try_smooth(v)) ++n;
  return n;
}

bool TriangleSweep::try_smooth(VertexHandle v) {
  const MotionConstraint& motion_constraint = surface_.motion_constraint(v);
  const bool on_curve = motion_constraint.kind == SurfaceKind::kCurve;
  const bool is_free = surface_.options().mode == SurfaceMode::kFree;
  Star star;
  if (!gather(v, star)) return false;
  const Vec3 axis = !on_curve && is_free ? star.normal : motion_constraint.axis;
  if (axis == Vec3{}) return false;
  const Vec3 lift = is_free && !on_curve && !star.is_flat() ? surface_.outward() * axis : Vec3{};
  const Vec3 origin = point(v);
  Vec3 place = climb(
      origin, 0.5 * star.mean_edge, axis, on_curve, [&](Vec3 x) { return surface_.project(v, x + lift); },
      [&](Vec3 x, double floor) { return star.worst_with(x, floor); });
  for (int i = 0; i < 3 && place != origin; ++i) {
    if (star.worst_with(place, star.worst) > star.worst &&
        surface_.keeps_shape(star.faces, star.removed, star.moved_to(place))) {
      points_[v.idx()] = place;
      surface_.on_move(v, place);
      for (const Face& f : star.faces)
        for (VertexHandle w : f) touch(w);
      return true;
    }
    place = surface_.project(v, origin + 0.5 * (place - origin));
  }
  return false;
}

std::size_t TriangleSweep::offset() {
  std::vector<Face> all;
  for (std::size_t f = 0; f < surface_.n_faces(); ++f)
    if (!surface_.is_deleted(f)) all.push_back(surface_.face_vertices(f));
  std::size_t n = 0;
  for (VertexHandle v : free_vertices(all))
    if (try_offset(v)) ++n;
  return n;
}

bool TriangleSweep::try_offset(VertexHandle v) {
  constexpr double kTrifle = 0.97;
  Star star;
  if (surface_.motion_constraint(v).kind != SurfaceKind::kFacet || !gather(v, star) || star.is_flat())
    return false;
  const Vec3 place = point(v) + surface_.outward() * star.normal;
  const double floor = std::max(kTrifle * star.worst, std::min(star.worst, below_));
  if (place == point(v) || !(star.worst_with(place, floor) > floor) ||
      !surface_.keeps_shape(star.faces, star.removed, star.moved_to(place)))
    return false;
  points_[v.idx()] = place;
  surface_.on_move(v, place);
  return true;
}

std::size_t TriangleSweep::split() {
  std::size_t n = 0;
  for (const Face& f : look(kSplit)) {
    if (!still_there(f) || !(decision(f) < below_)) continue;
    std::array<std::size_t, 3> order = {0, 1, 2};  // the longest edge first
    const auto length2 = [&](std::size_t k) { return norm2(point(f[(k + 1) % 3]) - point(f[k])); };
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      return length2(i) != length2(j) ? length2(i) > length2(j) : f[i] < f[j];
    });
    for (std::size_t k : order)
      if (try_split(f[k], f[(k + 1) % 3])) {
        ++n;
        break;
      }
  }
  return n;
}

/// Where the new vertex is best, and what the worst triangle is then.
void TriangleSweep::place(Insertion& cavity) const {
  const auto triangle = [&](std::size_t i, Vec3 x) {
    return Triangle{x, point(cavity.polygon[i]), point(cavity.polygon[(i + 1) % cavity.polygon.size()])};
  };
  // By edge of the polygon; at a feature each face has its own.
  Vec3 sum;
  for (const Face& f : cavity.faces) sum = sum + scaled_normal(corners(f));
  std::vector<Vec3> outside(cavity.n_edges(), sum);
  for (std::size_t i = 0; i < outside.size() && cavity.on_line; ++i) {
    const VertexHandle p = cavity.polygon[i], q = cavity.polygon[(i + 1) % cavity.polygon.size()];
    for (const Face& f : cavity.faces)
      for (std::size_t k = 0; k < 3; ++k)
        if (f[k] == p && f[(k + 1) % 3] == q) outside[i] = scaled_normal(corners(f));
  }
  const auto decision_of = [&](std::size_t i, const Triangle& t) {
    return dot(scaled_normal(t), outside[i]) > 0 ? triangle_decision(t) : 0.0;
  };
  const auto value = [&](Vec3 x, double floor) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cavity.n_edges() && least > floor; ++i)
      least = std::min(least, decision_of(i, triangle(i, x)));
    return least;
  };
  const auto project = [&](Vec3 x) {
    const Vec3 r = x - cavity.anchor;
    return cavity.on_line ? cavity.anchor + dot(r, cavity.axis) * cavity.axis
                          : x - dot(r, cavity.axis) * cavity.axis;
  };
  cavity.middle = climb(cavity.middle, 0.25 * cavity.size, cavity.axis, cavity.on_line, project, value);
  cavity.worst_new = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cavity.n_edges(); ++i) {
    const double now = decision_of(i, triangle(i, cavity.middle));
    if (now < cavity.worst_new) {
      cavity.worst_new = now;
      cavity.weakest = i;
    }
  }
}

bool TriangleSweep::try_split(VertexHandle a, VertexHandle b) {
  if (!surface_.may_split(a, b)) return false;
  const auto [c, d] = surface_.across(a, b);
  Insertion cavity;
  cavity.closed = c.is_valid() && d.is_valid();
  if (cavity.closed) {
    cavity.polygon = {a, d, b, c};
    cavity.faces = {{a, b, c}, {b, a, d}};
  } else if (c.is_valid()) {
    cavity.polygon = {b, c, a};
    cavity.faces = {{a, b, c}};
  } else if (d.is_valid()) {
    cavity.polygon = {a, d, b};
    cavity.faces = {{b, a, d}};
  } else {
    return false;
  }
  for (const Face& f : cavity.faces) cavity.worst = std::min(cavity.worst, decision(f));
  cavity.on_line = surface_.is_feature(a, b);
  cavity.middle = 0.5 * (point(a) + point(b));
  cavity.anchor = point(a);
  cavity.size = norm(point(b) - point(a));
  if (cavity.on_line) {
    cavity.axis = unit(point(b) - point(a));
  } else {
    Vec3 normal;
    for (const Face& f : cavity.faces) normal = normal + scaled_normal(corners(f));
    cavity.axis = unit(normal);
  }
  if (cavity.axis == Vec3{}) return false;
  for (place(cavity); !(cavity.worst_new > kSplitGain * cavity.worst); place(cavity)) {
    if (cavity.polygon.size() >= kMaxPolygon) return false;
    const VertexHandle p = cavity.polygon[cavity.weakest];
    const VertexHandle q = cavity.polygon[(cavity.weakest + 1) % cavity.polygon.size()];
    const VertexHandle e = surface_.across(p, q)[1];  // the polygon is on the left
    const bool known = std::find(cavity.polygon.begin(), cavity.polygon.end(), e) != cavity.polygon.end();
    if (!e.is_valid() || known || !surface_.is_inner(p, q)) return false;
    cavity.flips.push_back({p, q});
    cavity.faces.push_back({q, p, e});
    cavity.worst = std::min(cavity.worst, decision(cavity.faces.back()));
    cavity.polygon.insert(cavity.polygon.begin() + static_cast<std::ptrdiff_t>(cavity.weakest) + 1, e);
  }
  std::vector<Triangle> removed, created;
  for (const Face& f : cavity.faces) removed.push_back(corners(f));
  for (std::size_t i = 0; i < cavity.n_edges(); ++i)
    created.push_back(
        {cavity.middle, point(cavity.polygon[i]), point(cavity.polygon[(i + 1) % cavity.polygon.size()])});
  if (!surface_.keeps_shape(cavity.faces, removed, created)) return false;
  const VertexHandle middle(points_.size());
  points_.push_back(cavity.middle);
  changed_.push_back(clock_);
  surface_.on_split(a, b, middle, cavity.middle);
  for (const auto& [p, q] : cavity.flips) surface_.on_swap(p, q);
  for (VertexHandle v : cavity.polygon) touch(v);
  return true;
}

}  // namespace hfr
