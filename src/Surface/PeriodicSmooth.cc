// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/PeriodicSmooth.hh"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Operators/MaxMinForm.hh"
#include "Operators/Metrics.hh"
#include "Operators/Smooth.hh"
#include "Quality/Damage.hh"
#include "Surface/Features.hh"
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

/// The members of an orbit. Nothing where a star is too large or has an interface, or two stars share a cell.
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

/// Search for the step of an orbit whose members are known.
template <class Metric>
class OrbitSearch {
 public:
  using Plan = typename PeriodicSmooth<Metric>::Plan;

  OrbitSearch(const TetMesh& mesh, const PeriodicSmooth<Metric>& op, const std::vector<Member>& members)
      : mesh_(mesh), op_(op), members_(members), origin_(members.front().place) {
    for (const Member& member : members) {
      old_worst_ = std::min(old_worst_, worst_of(member.link, op.quality));
      n_links_ += member.link.size();
      for (HalfFaceHandle h : member.link) {
        n_invalid_ += op.quality[cell_of(h).idx()] > 0 ? 0 : 1;
        damage_.add(mesh, cell_of(h));
        for (VertexHandle w : mesh.halfface_vertices(h)) length_ += norm(mesh.point(w) - member.place);
      }
    }
    worst_now_ = old_worst_;
  }

  /// The best step along `axis` or, where the vertices are on no curve, normal to it.
  void look_for_step(Vec3 axis, bool on_curve) {
    if (kMeasuresAngles<Metric> && old_worst_ > 0) climb(axis, on_curve);
    if (step_ == Vec3{}) try_places(axis, on_curve);
  }

  /// The step that was found or, where the shape or other cells forbid it, one half or a quarter as long.
  std::optional<Plan> plan() const {
    Vec3 step = step_;
    for (int i = 0; i < 3 && step != Vec3{}; ++i, step = 0.5 * step) {
      Plan plan;
      plan.old_worst = old_worst_;
      plan.targets = targets_of(step);
      if (plan.targets.empty()) continue;
      plan.new_worst = worst_at(plan.targets, old_worst_);
      if (plan.new_worst > old_worst_ && may_be_made(plan.targets)) return plan;
    }
    return std::nullopt;
  }

 private:
  /// Each vertex is put back onto its own plane or line. Where that makes their steps differ, there is none.
  std::vector<Vec3> targets_of(Vec3 step) const {
    const double tolerance = 1e-12 * length_;
    std::vector<Vec3> targets;
    for (const Member& member : members_)
      targets.push_back(op_.surface->project(member.v, member.place + step));
    for (std::size_t i = 1; i < targets.size(); ++i)
      if (norm((targets[i] - members_[i].place) - (targets[0] - origin_)) > tolerance) targets.clear();
    return targets;
  }

  double worst_at(const std::vector<Vec3>& targets, double at_least) const {
    double worst = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < targets.size() && worst > at_least; ++i)
      worst = std::min(worst,
                       worst_with(mesh_, members_[i].v, members_[i].link, targets[i], op_.metric, at_least));
    return worst;
  }

  bool consider(Vec3 wanted) {
    const std::vector<Vec3> targets = targets_of(wanted);
    if (targets.empty()) return false;
    const double worst = worst_at(targets, worst_now_);
    if (!(worst > worst_now_)) return false;
    worst_now_ = worst;
    step_ = targets[0] - origin_;
    return true;
  }

  void climb(Vec3 axis, bool on_curve) {
    MaxMinForm form(origin_, MaxMinForm::kAnglesOf<Metric>);
    form.confine(on_curve ? MaxMinForm::Room::kLine : MaxMinForm::Room::kPlane, axis);
    for (const Member& member : members_) {
      const Vec3 back = origin_ - member.place;
      for (HalfFaceHandle h : member.link) {
        const auto f = mesh_.halfface_vertices(h);
        form.add(mesh_.point(f[0]) + back, mesh_.point(f[1]) + back, mesh_.point(f[2]) + back);
      }
    }
    consider(form.ascend(origin_, op_.iterations) - origin_);
  }

  void try_places(Vec3 axis, bool on_curve) {
    // Directions along the axes, so that coordinates that have to stay do so to the last bit.
    std::array<Vec3, 3> ways = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    for (Vec3& way : ways) way = on_curve ? dot(way, axis) * axis : way - dot(way, axis) * axis;
    const auto steps_at = [&](double r) {
      FixedVector<Vec3, 6> steps;
      for (const Vec3 way : ways)
        for (const double s : {1.0, -1.0}) steps.push_back(step_ + (s * r) * way);
      return steps;
    };
    const double radius = 0.5 * length_ / (3.0 * static_cast<double>(n_links_));
    surface::search_places_by_halving(radius, op_.halvings, steps_at,
                                      [&](Vec3 wanted) { return consider(wanted); });
  }

  bool may_be_made(const std::vector<Vec3>& targets) const {
    std::ptrdiff_t n_left = 0;
    Damage left;
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const Member& member = members_[k];
      for (HalfFaceHandle h : member.link) {
        n_left += quality_with(mesh_, cell_of(h), member.v, targets[k], op_.metric) > 0 ? 0 : 1;
        left.add(mesh_, cell_of(h), member.v, targets[k]);
      }
      std::vector<Triangle> created;
      for (std::size_t f = 0; f < member.faces.size(); ++f)
        created.push_back(with(member.removed[f], member.faces[f], member.v, targets[k]));
      if (!op_.surface->keeps_shape(member.faces, member.removed, created)) return false;
    }
    return n_left <= n_invalid_ && damage_.may_become(left, op_.floor);
  }

  const TetMesh& mesh_;
  const PeriodicSmooth<Metric>& op_;
  const std::vector<Member>& members_;
  Vec3 origin_;  // of the first member
  double old_worst_ = std::numeric_limits<double>::infinity();
  double worst_now_ = 0;  // with step_
  Vec3 step_;
  double length_ =
      0;  // of all edges at the members, sides of their links counted as often as they have faces
  std::size_t n_links_ = 0;
  std::ptrdiff_t n_invalid_ = 0;
  Damage damage_;
};

}  // namespace

template <class Metric>
auto PeriodicSmooth<Metric>::evaluate(const TetMesh& mesh, std::span<const VertexHandle> orbit) const
    -> std::optional<Plan> {
  const MotionConstraint& motion_constraint = surface->motion_constraint(orbit[0]);
  const bool on_curve = motion_constraint.kind == SurfaceKind::kCurve;
  if (!on_curve && motion_constraint.kind != SurfaceKind::kFacet) return std::nullopt;
  const auto members = gather(mesh, orbit);
  if (!members) return std::nullopt;
  const bool in_free = surface->options().mode == SurfaceMode::kFree;
  const Vec3 axis =
      in_free && !on_curve ? surface::area_normal(members->front().removed) : motion_constraint.axis;
  if (axis == Vec3{}) return std::nullopt;
  OrbitSearch<Metric> search(mesh, *this, *members);
  search.look_for_step(axis, on_curve);
  return search.plan();
}

HFR_INSTANTIATE_FOR_METRICS(PeriodicSmooth)

}  // namespace hfr
