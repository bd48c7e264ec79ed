// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/PeriodicSmooth.hh"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Operators/MaxMinForm.hh"
#include "Operators/Metrics.hh"
#include "Operators/Smooth.hh"
#include "Quality/Damage.hh"
#include "Surface/TangentSearch.hh"

namespace hfr {
namespace {

/// One vertex of an orbit with its cells and its faces of the surface.
struct Member {
  VertexHandle v;
  Vec3 place;
  std::vector<HalfFaceHandle> link;
  std::vector<std::array<VertexHandle, 3>> faces;  // seen from outside
  std::vector<Triangle> removed;
};

Triangle with(Triangle t, const std::array<VertexHandle, 3>& f, VertexHandle v, Vec3 x) {
  for (std::size_t k = 0; k < 3; ++k)
    if (f[k] == v) t[k] = x;
  return t;
}

/// Nothing where a star is too large or has an interface, or two stars share a cell.
std::optional<std::vector<Member>> gather(const TetMesh& mesh, std::span<const VertexHandle> orbit) {
  std::vector<Member> members;
  std::vector<CellHandle> cells;
  Star star;
  for (VertexHandle v : orbit) {
    Member& member = members.emplace_back();
    member.v = v;
    member.place = mesh.point(v);
    if (!mesh.gather_star(v, star)) return std::nullopt;
    for (std::size_t i = 0; i < static_cast<std::size_t>(star.size); ++i) {
      const CellHandle c = star.cells[i];
      cells.push_back(c);
      if (mesh.region(c) != mesh.region(star.cells[0])) return std::nullopt;
      member.link.push_back(halfface_of(c, star.corners[i]));
      for (int k = 0; k < 4; ++k) {
        if (k == star.corners[i] || !mesh.is_boundary(halfface_of(c, k))) continue;
        const auto f = mesh.halfface_vertices(halfface_of(c, k));
        member.faces.push_back({f[0], f[2], f[1]});
        member.removed.push_back({mesh.point(f[0]), mesh.point(f[2]), mesh.point(f[1])});
      }
    }
  }
  std::sort(cells.begin(), cells.end());
  if (std::adjacent_find(cells.begin(), cells.end()) != cells.end()) return std::nullopt;
  return members;
}

Vec3 area_normal(const Member& member) {
  Vec3 sum;
  for (const Triangle& t : member.removed) sum = sum + cross(t[1] - t[0], t[2] - t[0]);
  const double length = norm(sum);  // by division: along an axis it is that axis to the last bit
  return length > 0 ? Vec3{sum.x / length, sum.y / length, sum.z / length} : sum;
}

}  // namespace

template <class Metric>
auto PeriodicSmooth<Metric>::evaluate(const TetMesh& mesh, std::span<const VertexHandle> orbit) const
    -> std::optional<Plan> {
  const MotionConstraint& motion_constraint = surface->motion_constraint(orbit[0]);
  const bool on_curve = motion_constraint.kind == SurfaceKind::kCurve;
  if (!on_curve && motion_constraint.kind != SurfaceKind::kFacet) return std::nullopt;
  const auto members = gather(mesh, orbit);
  if (!members) return std::nullopt;
  const Vec3 origin = members->front().place;
  const bool in_free = surface->options().mode == SurfaceMode::kFree;
  const Vec3 axis = in_free && !on_curve ? area_normal(members->front()) : motion_constraint.axis;
  if (axis == Vec3{}) return std::nullopt;

  std::ptrdiff_t n_invalid = 0;
  Damage damage;
  Plan plan;
  plan.old_worst = std::numeric_limits<double>::infinity();
  double length = 0;
  std::size_t n_links = 0;
  for (const Member& member : *members) {
    plan.old_worst = std::min(plan.old_worst, worst_of(member.link, quality));
    n_links += member.link.size();
    for (HalfFaceHandle h : member.link) {
      n_invalid += quality[cell_of(h).idx()] > 0 ? 0 : 1;
      damage.add(mesh, cell_of(h));
      for (VertexHandle w : mesh.halfface_vertices(h)) length += norm(mesh.point(w) - member.place);
    }
  }
  // Every vertex goes to its own plane or line; a step that these part is none of the orbit.
  const double tolerance = 1e-12 * length;
  const auto targets_of = [&](Vec3 step) {
    std::vector<Vec3> targets;
    for (const Member& member : *members) targets.push_back(surface->project(member.v, member.place + step));
    for (std::size_t i = 1; i < targets.size(); ++i)
      if (norm((targets[i] - (*members)[i].place) - (targets[0] - origin)) > tolerance) targets.clear();
    return targets;
  };
  const auto worst_at = [&](const std::vector<Vec3>& targets, double at_least) {
    double worst = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < targets.size() && worst > at_least; ++i)
      worst = std::min(worst,
                       worst_with(mesh, (*members)[i].v, (*members)[i].link, targets[i], metric, at_least));
    return worst;
  };
  double worst_now = plan.old_worst;
  Vec3 step;
  const auto consider = [&](Vec3 wanted) {
    const std::vector<Vec3> targets = targets_of(wanted);
    if (targets.empty()) return false;
    const double worst = worst_at(targets, worst_now);
    if (!(worst > worst_now)) return false;
    worst_now = worst;
    step = targets[0] - origin;
    return true;
  };
  if (kMeasuresAngles<Metric> && plan.old_worst > 0) {
    MaxMinForm form(origin, MaxMinForm::kAnglesOf<Metric>);
    form.confine(on_curve ? MaxMinForm::Room::kLine : MaxMinForm::Room::kPlane, axis);
    for (const Member& member : *members) {
      const Vec3 back = origin - member.place;
      for (HalfFaceHandle h : member.link) {
        const auto f = mesh.halfface_vertices(h);
        form.add(mesh.point(f[0]) + back, mesh.point(f[1]) + back, mesh.point(f[2]) + back);
      }
    }
    consider(form.ascend(origin, iterations) - origin);
  }
  if (step == Vec3{}) {
    // Directions along the coordinates, so that those that have to stay do so to the last bit.
    std::array<Vec3, 3> ways = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    for (Vec3& way : ways) way = on_curve ? dot(way, axis) * axis : way - dot(way, axis) * axis;
    const auto steps_at = [&](double r) {
      FixedVector<Vec3, 6> steps;
      for (const Vec3 way : ways)
        for (const double s : {1.0, -1.0}) steps.push_back(step + (s * r) * way);
      return steps;
    };
    const double radius = 0.5 * length / (3.0 * static_cast<double>(n_links));
    surface::search_places_by_halving(radius, halvings, steps_at, consider);
  }
  for (int i = 0; i < 3 && step != Vec3{}; ++i, step = 0.5 * step) {
    plan.targets = targets_of(step);
    if (plan.targets.empty()) continue;
    plan.new_worst = worst_at(plan.targets, plan.old_worst);
    if (!(plan.new_worst > plan.old_worst)) continue;
    std::ptrdiff_t n_left = 0;
    Damage left;
    bool keeps = true;
    for (std::size_t k = 0; k < plan.targets.size() && keeps; ++k) {
      const Member& member = (*members)[k];
      for (HalfFaceHandle h : member.link) {
        n_left += quality_with(mesh, cell_of(h), member.v, plan.targets[k], metric) > 0 ? 0 : 1;
        left.add(mesh, cell_of(h), member.v, plan.targets[k]);
      }
      std::vector<Triangle> created;
      for (std::size_t f = 0; f < member.faces.size(); ++f)
        created.push_back(with(member.removed[f], member.faces[f], member.v, plan.targets[k]));
      keeps = surface->keeps_shape(member.faces, member.removed, created);
    }
    if (keeps && n_left <= n_invalid && damage.may_become(left, floor)) return plan;
  }
  return std::nullopt;
}

HFR_INSTANTIATE_FOR_METRICS(PeriodicSmooth)

}  // namespace hfr
