// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceSmooth.hh"

#include <algorithm>
#include <cmath>

#include "Operators/MaxMinForm.hh"
#include "Operators/Metrics.hh"
#include "Operators/StarForm.hh"
#include "Surface/Features.hh"
#include "Surface/TangentSearch.hh"

namespace hfr {

using surface::normal_to;
using surface::search_by_halving;
using surface::TangentSteps;

namespace {

static_assert(2 * TangentSteps::kMost <= StarForm::kTrials);

/// The surface round a vertex, before and after a move.
struct Patch {
  FixedVector<std::array<VertexHandle, 3>, kMaxFacesOfVertex> faces;
  FixedVector<Triangle, kMaxFacesOfVertex> removed;
  FixedVector<std::uint8_t, kMaxFacesOfVertex> corner;  // of the vertex
  bool has_interface = false;

  /// The faces of the surface at v. False when they are too many.
  bool gather(const TetMesh& mesh, VertexHandle v, std::span<const HalfFaceHandle> link) {
    for (HalfFaceHandle h : link) {
      for (HalfFaceHandle g : mesh.cell_halffaces(cell_of(h))) {
        if (g == h) continue;
        const HalfFaceHandle m = mesh.opposite_halfface(g);  // an interface counts from the smaller region
        if (m.is_valid() && !(mesh.region(cell_of(g)) < mesh.region(cell_of(m)))) continue;
        has_interface = has_interface || m.is_valid();
        const auto f = mesh.halfface_vertices(g);
        if (faces.full()) return false;
        faces.push_back({f[0], f[2], f[1]});
        removed.push_back({mesh.point(f[0]), mesh.point(f[2]), mesh.point(f[1])});
        corner.push_back(f[0] == v ? 0 : f[2] == v ? 1 : 2);
      }
    }
    return true;
  }
  bool keeps_shape(const SurfaceMesh& surface, Vec3 x) const {
    FixedVector<Triangle, kMaxFacesOfVertex> created = removed;
    for (std::size_t i = 0; i < created.size(); ++i) created[i][corner[i]] = x;
    return surface.keeps_shape(faces, removed, created);
  }
  /// True when the faces lie in one plane, as far as rounding lets them: such a vertex stays in it.
  bool is_flat() const {
    constexpr double kLevel = 1.0 - 1e-9;
    const Vec3 n = normal();
    return std::all_of(removed.begin(), removed.end(), [&](const Triangle& t) {
      const Vec3 m = cross(t[1] - t[0], t[2] - t[0]);
      return dot(n, m) >= kLevel * norm(m);
    });
  }
  Vec3 normal() const { return surface::area_normal(removed); }
};

/// Half the mean length of the edges from `origin` to the vertices of the link.
double half_mean_edge(const TetMesh& mesh, Vec3 origin, std::span<const HalfFaceHandle> link) {
  double length = 0;
  for (HalfFaceHandle h : link)
    for (VertexHandle w : mesh.halfface_vertices(h)) length += norm(mesh.point(w) - origin);
  return 0.5 * length / (3.0 * static_cast<double>(link.size()));
}

void add_star(const TetMesh& mesh, std::span<const HalfFaceHandle> link, MaxMinForm& form) {
  for (HalfFaceHandle h : link) {
    const auto f = mesh.halfface_vertices(h);
    form.add(mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2]));
  }
}

/// True when none of up to StarForm::kTrials places, which for_places(ask) tells relative to the vertex, has
/// a star whose worst cell is better than `floor` > 0, beyond what rounding in another formula may do. All
/// are looked at together.
template <class ForPlaces>
bool all_fall_short(StarForm& star, double floor, ForPlaces&& for_places) {
  constexpr double kSurely = 1 - 1e-6;
  StarForm::Trials x{}, y{}, z{}, worst;
  std::size_t n = 0;
  for_places([&](Vec3 place) {
    x[n] = place.x;
    y[n] = place.y;
    z[n] = place.z;
    ++n;
  });
  for (std::size_t i = n; i < StarForm::kTrials; ++i) {  // what is left repeats the last
    x[i] = x[n - 1];
    y[i] = y[n - 1];
    z[i] = z[n - 1];
  }
  star.worst(x, y, z, kSurely * floor, worst);
  return std::none_of(worst.begin(), worst.end(), [&](double w) { return w > kSurely * floor; });
}

}  // namespace

template <class Metric>
std::optional<Move> SurfaceSearch::operator()(const TetMesh& mesh, VertexHandle v,
                                              std::span<const HalfFaceHandle> link, const Metric& metric,
                                              std::span<const double> quality) const {
  const MotionConstraint& motion_constraint = surface->motion_constraint(v);
  const bool on_curve = motion_constraint.kind == SurfaceKind::kCurve;
  if (!on_curve && motion_constraint.kind != SurfaceKind::kFacet) return std::nullopt;
  Patch patch;
  if (!patch.gather(mesh, v, link)) return std::nullopt;
  const Vec3 origin = mesh.point(v);
  Vec3 axis = motion_constraint.axis;
  if (!on_curve && surface->options().mode == SurfaceMode::kFree) axis = patch.normal();
  if (axis == Vec3{}) return std::nullopt;
  // In the plane normal to the axis the volume stays; a little outwards makes up for what swaps have cost.
  const bool bulges =
      surface->options().mode == SurfaceMode::kFree && !on_curve && !patch.has_interface && !patch.is_flat();
  const Vec3 lift = bulges ? surface->outward() * axis : Vec3{};

  Move move;
  move.old_worst = worst_of(link, quality);
  const double floor = move.old_worst > 0 ? gain * move.old_worst : move.old_worst;
  double worst_now = floor;
  Vec3 place = origin;
  const auto consider = [&](Vec3 x) {
    const Vec3 candidate = surface->project(v, x + lift);
    const double worst = worst_with(mesh, v, link, candidate, metric, worst_now);
    if (!(worst > worst_now)) return false;
    worst_now = worst;
    place = candidate;
    return true;
  };
  if (kMeasuresAngles<Metric> && move.old_worst > 0) {
    MaxMinForm form(origin, MaxMinForm::kAnglesOf<Metric>);
    form.confine(on_curve ? MaxMinForm::Room::kLine : MaxMinForm::Room::kPlane, axis);
    add_star(mesh, link, form);
    consider(form.ascend(origin, iterations));
  }
  if (place == origin) {
    Vec3 u = normal_to(axis);
    u = (1.0 / norm(u)) * u;  // unit() divides, which may give another last bit
    const TangentSteps steps = on_curve ? TangentSteps::on_line(axis) : TangentSteps::in_plane(axis, u);
    std::optional<StarForm> star;
    if (std::is_same_v<Metric, VolumeLength> && move.old_worst > 0) star.emplace(mesh, v, link);
    search_by_halving(half_mean_edge(mesh, origin, link), halvings, [&](double r) {
      const Vec3 centre = place;
      const bool hopeless = star && all_fall_short(*star, worst_now, [&](auto&& ask) {
                              for (double near : {r, 0.5 * r})
                                for (Vec3 x : steps.at(near, centre))
                                  ask(surface->project(v, x + lift) - origin);
                            });
      if (hopeless) return 2;
      bool better = false;
      for (Vec3 x : steps.at(r, centre)) better = consider(x) || better;
      return better ? 0 : 1;
    });
  }
  // Where the shape forbids the place, one nearer by may do.
  for (int i = 0; i < 3 && place != origin; ++i) {
    const double worst = worst_with(mesh, v, link, place, metric, floor);
    if (worst > floor && patch.keeps_shape(*surface, place)) {
      move.target = place;
      move.new_worst = worst;
      return move;
    }
    place = surface->project(v, origin + 0.5 * (place - origin));
  }
  return std::nullopt;
}

template <class Metric>
std::optional<Move> SurfaceOffset::operator()(const TetMesh& mesh, VertexHandle v,
                                              std::span<const HalfFaceHandle> link, const Metric& metric,
                                              std::span<const double> quality) const {
  constexpr double kTrifle = 0.97;   // share of the worst decision value of a star that it has to keep
  constexpr double kFarAbove = 1.1;  // times `worst`: a star above this may become a trifle worse
  if (surface->motion_constraint(v).kind != SurfaceKind::kFacet) return std::nullopt;
  Patch patch;
  if (!patch.gather(mesh, v, link) || patch.has_interface || patch.is_flat()) return std::nullopt;
  Move move;
  move.old_worst = worst_of(link, quality);
  move.target = mesh.point(v) + surface->outward() * patch.normal();
  const double floor = move.old_worst > kFarAbove * worst
                           ? std::max(kFarAbove * worst, kTrifle * move.old_worst)
                           : move.old_worst;
  move.new_worst = worst_with(mesh, v, link, move.target, metric, floor);
  if (!(move.new_worst > floor) || !patch.keeps_shape(*surface, move.target)) return std::nullopt;
  return move;
}

HFR_INSTANTIATE_SEARCH(SurfaceSearch)
HFR_INSTANTIATE_SEARCH(SurfaceOffset)

}  // namespace hfr
