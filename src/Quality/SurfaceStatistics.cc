// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/SurfaceStatistics.hh"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "Quality/FixedSum.hh"
#include "Quality/Metrics.hh"

namespace hfr::detail {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

// Half-faces with frozen faces, ascending.
std::vector<Index> frozen_halffaces(const TetMesh& mesh, par::Policy policy) {
  return par::compact<Index>(policy, 4 * mesh.n_cells(), [&](std::size_t i) {
    const HalfFaceHandle h(i);
    return !mesh.is_deleted(cell_of(h)) && mesh.is_constrained(h);
  });
}

double face_area(const TetMesh& mesh, HalfFaceHandle h) {
  const auto [a, b, c] = mesh.halfface_vertices(h);
  const Vec3 p = mesh.point(a);
  return 0.5 * norm(cross(mesh.point(b) - p, mesh.point(c) - p));
}

std::vector<PatchStatistics> gather_patches(const TetMesh& mesh, const std::vector<Index>& frozen,
                                            double max_area) {
  struct Totals {
    std::size_t faces = 0;
    FixedSum area;
  };
  std::map<int, Totals> patches;
  for (const Index i : frozen) {
    const HalfFaceHandle h(i);
    const HalfFaceHandle mate = mesh.opposite_halfface(h);
    if (mate.is_valid() && mate < h) continue;
    const auto& labels = mesh.labels().faces;
    const int* label = labels.empty() ? nullptr : labels.find(mesh.halfface_vertices(h));
    if (label == nullptr && mate.is_valid()) continue;
    const auto [at, is_new] = patches.try_emplace(label == nullptr ? 0 : *label);
    if (is_new) at->second.area = FixedSum(max_area);
    ++at->second.faces;
    at->second.area.add(face_area(mesh, h));
  }
  std::vector<PatchStatistics> result;
  for (const auto& [label, totals] : patches) result.push_back({label, totals.faces, totals.area.value()});
  return result;
}

// Where a walk round an edge stands: in cell c, about to leave through the face opposite corner `exit`.
struct WedgeWalk {
  CellHandle c;
  int a, b;   // corners of the edge
  int entry;  // corner opposite the face through which the cell was entered
  int exit;
};

// Dihedral of the cell at the edge of the walk, in radians; negative when inverted.
double dihedral_at(const TetMesh& mesh, const WedgeWalk& walk) {
  const Cell& cell = mesh.cell(walk.c);
  const auto point = [&](std::size_t corner) { return to_real3(mesh.point(cell.v[corner])); };
  const auto edge = kEdgeOfCorners[static_cast<std::size_t>(walk.a)][static_cast<std::size_t>(walk.b)];
  const hfr_cos_sin angle =
      hfr_dihedral_cos_sin(hfr_make_frame(point(0), point(1), point(2), point(3)), edge);
  return std::atan2(angle.sine, angle.cosine);
}

// Goes through the exit face, which must have a mate.
WedgeWalk next_cell(const TetMesh& mesh, const WedgeWalk& walk) {
  const Cell& from = mesh.cell(walk.c);
  const HalfFaceHandle m = from.mate[static_cast<std::size_t>(walk.exit)];
  const Cell& to = mesh.cell(cell_of(m));
  const auto corner_in_next = [&](int corner) { return to.corner(from.v[static_cast<std::size_t>(corner)]); };
  return {cell_of(m), corner_in_next(walk.a), corner_in_next(walk.b), corner_of(m),
          corner_in_next(walk.entry)};
}

// The angle between two frozen faces is fixed by them; what the cells between them add up to differs from it
// by whole turns when some are inverted.
double within_turn(double degrees) {
  const double turned = degrees - 360.0 * std::floor(degrees / 360.0);
  return turned > 0.0 ? turned : 360.0;
}

struct Ceilings {
  EdgeWedge surface, interface;

  static void lower(EdgeWedge& wedge, double degrees, const TetMesh& mesh, const WedgeWalk& start) {
    if (wedge.cell.is_valid() && degrees >= wedge.degrees) return;
    const Cell& cell = mesh.cell(start.c);
    wedge = {degrees, cell.v[static_cast<std::size_t>(start.a)], cell.v[static_cast<std::size_t>(start.b)],
             start.c};
  }
  void merge(const Ceilings& next) {
    if (next.surface.cell.is_valid() && (!surface.cell.is_valid() || next.surface.degrees < surface.degrees))
      surface = next.surface;
    if (next.interface.cell.is_valid() &&
        (!interface.cell.is_valid() || next.interface.degrees < interface.degrees))
      interface = next.interface;
  }
};

// Walks from the frozen half-face h round one of its edges, to the next frozen face and, when h is on the
// boundary, on to the boundary face at the other end. Each wedge is found from both of its ends and counts
// from the smaller half-face, so that it is summed in one order, and once.
void walk_wedge(const TetMesh& mesh, HalfFaceHandle h, const WedgeWalk& start, Ceilings& ceilings) {
  constexpr int kNone = -1;
  const bool from_boundary = !mesh.opposite_halfface(h).is_valid();
  int interface_steps = kNone;  // cells up to the next frozen face, when the wedge counts from h
  int surface_steps = kNone;
  bool in_first_wedge = true;
  WedgeWalk walk = start;
  for (int steps = 1;; ++steps) {
    const HalfFaceHandle end = halfface_of(walk.c, walk.exit);
    if (in_first_wedge && mesh.is_constrained(end)) {
      in_first_wedge = false;
      if (h < end) interface_steps = steps;
    }
    const bool at_boundary = !mesh.opposite_halfface(end).is_valid();
    if (at_boundary && from_boundary && h < end) surface_steps = steps;
    if (at_boundary || (!in_first_wedge && !from_boundary)) break;
    walk = next_cell(mesh, walk);
    if (walk.c == start.c) break;
  }
  double degrees = 0.0;
  walk = start;
  for (int steps = 1; steps <= std::max(interface_steps, surface_steps); ++steps) {
    if (steps > 1) walk = next_cell(mesh, walk);
    degrees += kDegrees * dihedral_at(mesh, walk);
    if (steps == interface_steps) Ceilings::lower(ceilings.interface, within_turn(degrees), mesh, start);
    if (steps == surface_steps) Ceilings::lower(ceilings.surface, within_turn(degrees), mesh, start);
  }
}

Ceilings gather_ceilings(const TetMesh& mesh, par::Policy policy, const std::vector<Index>& frozen) {
  const int n_parts = par::thread_count(policy, frozen.size());
  std::vector<Ceilings> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    const std::size_t end = par::part_begin(frozen.size(), n_parts, part + 1);
    for (std::size_t i = par::part_begin(frozen.size(), n_parts, part); i < end; ++i) {
      const HalfFaceHandle h(frozen[i]);
      const int entry = corner_of(h);
      const auto& corners = kFaceCorners[static_cast<std::size_t>(entry)];
      for (std::size_t k = 0; k < 3; ++k)
        walk_wedge(mesh, h, {cell_of(h), corners[k], corners[(k + 1) % 3], entry, corners[(k + 2) % 3]},
                   found[static_cast<std::size_t>(part)]);
    }
  });
  Ceilings all;
  for (const Ceilings& part : found) all.merge(part);
  return all;
}

}  // namespace

SurfaceTotals gather_surface(const TetMesh& mesh, par::Policy policy, double max_area) {
  const std::vector<Index> frozen = frozen_halffaces(mesh, policy);
  const Ceilings ceilings = gather_ceilings(mesh, policy, frozen);
  return {gather_patches(mesh, frozen, max_area), ceilings.surface, ceilings.interface};
}

}  // namespace hfr::detail
