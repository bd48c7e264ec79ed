// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Limits.hh"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "Operators/Operator.hh"
#include "Quality/Metrics.hh"

namespace hfr {
namespace {

/// Degrees by which a wedge may exceed what its cells need by rounding alone.
constexpr double kRounding = 1e-9;

std::array<Vec3, 4> corners(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  return {mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])};
}

double smallest_angle(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  return report_value(Metric::kMinDihedral, MinDihedral{}(a, b, c, d));
}

/// The cells between two constrained faces at an edge.
struct Wedge {
  double degrees = 0;
  HalfFaceHandle first, last;  ///< the faces, as the cells of the wedge see them
};

/// Of local edge `edge` of cell c; nothing where the cells go all the way round or one is not positive.
std::optional<Wedge> wedge_at(const TetMesh& mesh, CellHandle c, int edge) {
  const auto& opposite = kEdgeOpposite[static_cast<std::size_t>(edge)];
  const auto& ends = kEdgeCorners[static_cast<std::size_t>(edge)];
  const VertexHandle a = mesh.cell(c).v[ends[0]];
  const VertexHandle b = mesh.cell(c).v[ends[1]];
  RingPlace at{c, opposite[0], opposite[1]};
  while (!mesh.is_constrained(halfface_of(at.cell, at.q))) {
    at = mesh.previous_in_ring(at);
    if (at.cell == c) return std::nullopt;
  }
  Wedge wedge;
  wedge.first = halfface_of(at.cell, at.q);
  for (;;) {
    const auto p = corners(mesh, at.cell);
    if (orientation(p[0], p[1], p[2], p[3]) <= 0) return std::nullopt;
    const Cell& cell = mesh.cell(at.cell);
    const auto angles = dihedrals(p[0], p[1], p[2], p[3]);
    for (std::size_t e = 0; e < 6; ++e) {
      const VertexHandle x = cell.v[kEdgeCorners[e][0]];
      const VertexHandle y = cell.v[kEdgeCorners[e][1]];
      if ((x == a && y == b) || (x == b && y == a)) wedge.degrees += angles[e];
    }
    wedge.last = halfface_of(at.cell, at.p);
    if (mesh.is_constrained(wedge.last)) return wedge;
    at = mesh.next_in_ring(at);
  }
}

/// The vertex of a face that is not on the edge.
VertexHandle third_vertex(const TetMesh& mesh, HalfFaceHandle h, VertexHandle a, VertexHandle b) {
  for (VertexHandle v : mesh.halfface_vertices(h))
    if (v != a && v != b) return v;
  return {};
}

/// True when no mesh has only angles of at least `degrees` in the wedge: it is too narrow for one cell, or
/// for two, and the one cell on both of its faces has a smaller angle elsewhere.
bool rules_out(const TetMesh& mesh, CellHandle c, int edge, const Wedge& wedge, double degrees) {
  if (wedge.degrees < degrees - kRounding) return true;
  if (!(wedge.degrees < 2 * degrees - kRounding)) return false;
  const auto& ends = kEdgeCorners[static_cast<std::size_t>(edge)];
  const VertexHandle a = mesh.cell(c).v[ends[0]];
  const VertexHandle b = mesh.cell(c).v[ends[1]];
  const VertexHandle p = third_vertex(mesh, wedge.last, a, b);
  const VertexHandle q = third_vertex(mesh, wedge.first, a, b);
  const double alone = std::max(smallest_angle(mesh.point(a), mesh.point(b), mesh.point(p), mesh.point(q)),
                                smallest_angle(mesh.point(a), mesh.point(b), mesh.point(q), mesh.point(p)));
  return alone < degrees - kRounding;
}

/// A proof by one of the cell's edges.
std::optional<Limit> ceiling_of(const TetMesh& mesh, CellHandle c, double degrees) {
  std::optional<Limit> found;
  for (int e = 0; e < 6; ++e) {
    const std::optional<Wedge> wedge = wedge_at(mesh, c, e);
    if (!wedge || !rules_out(mesh, c, e, *wedge, degrees)) continue;
    const bool surface = mesh.is_boundary(wedge->first) && mesh.is_boundary(wedge->last);
    if (surface) return Limit::kSurfaceCeiling;
    found = Limit::kInputFeature;
  }
  return found;
}

}  // namespace

std::vector<StuckCell> stuck_cells(const TetMesh& mesh, double degrees, bool out_of_budget,
                                   const std::vector<HalfFaceHandle>& folded, par::Policy policy) {
  const std::vector<std::uint8_t> frozen = constrained_vertices(mesh, policy);
  std::vector<std::uint8_t> on_fold(folded.empty() ? 0 : mesh.n_vertices(), 0);
  for (HalfFaceHandle h : folded)
    for (VertexHandle v : mesh.halfface_vertices(h)) on_fold[v.idx()] = 1;
  const double goal = std::sin(degrees * std::numbers::pi / 180.0);
  const auto low = par::compact<Index>(policy, mesh.n_cells(), [&](std::size_t i) {
    if (mesh.is_deleted(CellHandle(i))) return false;
    const auto p = corners(mesh, CellHandle(i));
    return MinDihedral{}(p[0], p[1], p[2], p[3]) < goal * goal;
  });
  std::vector<StuckCell> cells(low.size());
  par::for_each(policy, low.size(), [&](std::size_t i) {
    StuckCell& stuck = cells[i];
    stuck.cell = CellHandle(low[i]);
    const auto p = corners(mesh, stuck.cell);
    stuck.degrees = smallest_angle(p[0], p[1], p[2], p[3]);
    bool folds = false;
    for (VertexHandle v : mesh.cell(stuck.cell).v) {
      stuck.n_frozen_vertices += frozen[v.idx()];
      folds = folds || (!on_fold.empty() && on_fold[v.idx()]);
    }
    const bool invalid = orientation(p[0], p[1], p[2], p[3]) <= 0;
    if (invalid && folds)
      stuck.limit = Limit::kFoldedSurface;
    else if (const auto ceiling = ceiling_of(mesh, stuck.cell, degrees))
      stuck.limit = *ceiling;
    else if (out_of_budget)
      stuck.limit = Limit::kBudget;
    else
      stuck.limit = stuck.n_frozen_vertices == 4 ? Limit::kFrozenVertices : Limit::kSearch;
  });
  return cells;
}

std::array<std::size_t, kLimitNames.size()> count_limits(const std::vector<StuckCell>& cells) {
  std::array<std::size_t, kLimitNames.size()> counts{};
  for (const StuckCell& stuck : cells) ++counts[static_cast<std::size_t>(stuck.limit)];
  return counts;
}

}  // namespace hfr
