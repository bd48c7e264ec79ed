// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/SurfaceStatistics.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "Quality/FixedSum.hh"
#include "Quality/Metrics.hh"
#include "Quality/Wedges.hh"

namespace hfr::detail {
namespace {

double face_area(const TetMesh& mesh, HalfFaceHandle h) {
  const auto [a, b, c] = mesh.halfface_vertices(h);
  const Vec3 p = mesh.point(a);
  return 0.5 * norm(cross(mesh.point(b) - p, mesh.point(c) - p));
}

std::vector<PatchStatistics> gather_patches(const TetMesh& mesh, std::span<const HalfFaceHandle> constrained,
                                            double max_area) {
  struct Totals {
    std::size_t faces = 0;
    FixedSum area;
  };
  std::map<int, Totals> patches;
  for (const HalfFaceHandle h : constrained) {
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

struct Ceilings {
  EdgeWedge surface, interface, angle;
  // Of an angle that is surely too large to lower one of the three.
  double cosine_that_counts = -2;

  void note_what_counts() {
    constexpr double kRounding = 1e-4, kRadians = std::numbers::pi / 180.0;
    const double most = std::max({surface.degrees, interface.degrees, 2 * angle.degrees}) + kRounding;
    const bool all = surface.cell.is_valid() && interface.cell.is_valid() && angle.cell.is_valid();
    cosine_that_counts = all && most < 180 ? std::cos(kRadians * most) : -2;
  }

  static bool is_lower(double degrees, const EdgeWedge& least) {
    return !least.cell.is_valid() || degrees < least.degrees;
  }
  static void lower(EdgeWedge& least, double degrees, const Wedge& wedge, VertexHandle a, VertexHandle b) {
    if (is_lower(degrees, least)) least = {degrees, a, b, cell_of(wedge.first)};
  }
  void lower_angle(const TetMesh& mesh, const Wedge& wedge, VertexHandle a, VertexHandle b) {
    if (is_lower(0.5 * wedge.degrees, angle)) lower(angle, wedge_ceiling(mesh, a, b, wedge), wedge, a, b);
  }
  void merge(const Ceilings& next) {
    const auto take = [](EdgeWedge& least, const EdgeWedge& other) {
      if (other.cell.is_valid() && is_lower(other.degrees, least)) least = other;
    };
    take(surface, next.surface);
    take(interface, next.interface);
    take(angle, next.angle);
  }
};

// True when the walk round an edge that begins behind the frozen half-face h is the one that counts: it
// begins at the boundary if the edge is there, and behind the smallest of the half-faces that it could begin
// behind. So each edge is summed up once, and in one order.
bool counts_from(const TetMesh& mesh, HalfFaceHandle h, RingPlace start) {
  const bool from_boundary = !mesh.opposite_halfface(h).is_valid();
  for (RingPlace at = start;;) {
    const HalfFaceHandle exit = halfface_of(at.cell, at.p);
    const HalfFaceHandle beyond = mesh.opposite_halfface(exit);
    if (!beyond.is_valid()) return from_boundary && h < exit;
    const bool ends = cell_of(beyond) == start.cell;
    if (!from_boundary && mesh.is_constrained(exit) && (exit < h || (!ends && beyond < h))) return false;
    if (ends) return true;
    at = mesh.next_in_ring(at);
  }
}

// Cosine of a lower bound for the wedge of a boundary edge whose cells are positive, with no constrained face
// among them: the angle between its two faces, or what it lacks to a turn. NaN at any other edge.
double cosine_of_plain_wedge(const TetMesh& mesh, RingPlace start, VertexHandle a, VertexHandle b) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  RingPlace at = start;
  VertexHandle first, last;
  for (;;) {
    const Cell& cell = mesh.cell(at.cell);
    if (orientation(mesh.point(cell.v[0]), mesh.point(cell.v[1]), mesh.point(cell.v[2]),
                    mesh.point(cell.v[3])) <= 0)
      return kNone;
    if (!first.is_valid()) first = cell.v[at.p];
    last = cell.v[at.q];
    const HalfFaceHandle exit = halfface_of(at.cell, at.p);
    if (!mesh.opposite_halfface(exit).is_valid()) break;
    if (mesh.is_constrained(exit)) return kNone;
    at = mesh.next_in_ring(at);
    if (at.cell == start.cell) return kNone;
  }
  const Vec3 from = mesh.point(a), along = mesh.point(b) - from;
  const auto across = [&](VertexHandle v) {
    const Vec3 d = mesh.point(v) - from;
    return d - (dot(d, along) / dot(along, along)) * along;
  };
  const Vec3 u = across(first), w = across(last);
  return dot(u, w) / std::sqrt(dot(u, u) * dot(w, w));
}

void lower_at(const TetMesh& mesh, HalfFaceHandle h, std::size_t side, EdgeWedges& scratch,
              Ceilings& ceilings) {
  const auto q = static_cast<std::uint8_t>(corner_of(h));
  const auto& corners = kFaceCorners[q];
  const RingPlace start{cell_of(h), corners[(side + 2) % 3], q};
  if (!counts_from(mesh, h, start)) return;
  const Cell& cell = mesh.cell(start.cell);
  const VertexHandle a = cell.v[corners[side]];
  const VertexHandle b = cell.v[corners[(side + 1) % 3]];
  if (cosine_of_plain_wedge(mesh, start, a, b) < ceilings.cosine_that_counts) return;
  find_wedges(mesh, start, scratch);
  if (scratch.whole) Ceilings::lower(ceilings.surface, scratch.whole->degrees, *scratch.whole, a, b);
  for (const Wedge& wedge : scratch.wedges) {
    Ceilings::lower(ceilings.interface, wedge.degrees, wedge, a, b);
    ceilings.lower_angle(mesh, wedge, a, b);
  }
  ceilings.note_what_counts();
}

Ceilings gather_ceilings(const TetMesh& mesh, par::Policy policy,
                         std::span<const HalfFaceHandle> constrained) {
  const int n_parts = par::thread_count(policy, constrained.size());
  std::vector<Ceilings> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    const std::size_t end = par::part_begin(constrained.size(), n_parts, part + 1);
    EdgeWedges scratch;
    for (std::size_t i = par::part_begin(constrained.size(), n_parts, part); i < end; ++i) {
      for (std::size_t side = 0; side < 3; ++side)
        lower_at(mesh, constrained[i], side, scratch, found[static_cast<std::size_t>(part)]);
    }
  });
  Ceilings all;
  for (const Ceilings& part : found) all.merge(part);
  return all;
}

}  // namespace

SurfaceTotals gather_surface(const TetMesh& mesh, par::Policy policy,
                             std::span<const HalfFaceHandle> constrained, double max_area) {
  const Ceilings ceilings = gather_ceilings(mesh, policy, constrained);
  return {gather_patches(mesh, constrained, max_area), ceilings.surface, ceilings.interface, ceilings.angle};
}

}  // namespace hfr::detail
