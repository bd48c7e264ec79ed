// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Wedges.hh"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Quality/Metrics.hh"

namespace hfr {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
/// Degrees. Two faces that lie on one another to so much leave nothing or a whole turn, which they alone do
/// not tell: a slit, or a fold.
constexpr double kRounding = 1e-9;

struct Turn {
  double degrees;  // signed: negative in an inverted cell
  bool positive;
  bool known;  // not where a face at the edge has no area
};

/// What a cell of the ring takes of the turn round the edge.
Turn turn_of(const TetMesh& mesh, RingPlace at) {
  const Cell& cell = mesh.cell(at.cell);
  const auto point = [&](std::size_t corner) { return to_real3(mesh.point(cell.v[corner])); };
  const auto& p = mesh.points();
  const bool positive =
      orientation(p[cell.v[0].idx()], p[cell.v[1].idx()], p[cell.v[2].idx()], p[cell.v[3].idx()]) > 0;
  // The edge of the two corners that are neither p nor q.
  const auto edge = 5U - kEdgeOfCorners[at.p][at.q];
  const hfr_cos_sin angle =
      hfr_dihedral_cos_sin(hfr_make_frame(point(0), point(1), point(2), point(3)), static_cast<int>(edge));
  const bool known = angle.sine != 0 || angle.cosine != 0;
  return {kDegrees * std::atan2(angle.sine, angle.cosine), positive, known};
}

double within_turn(double degrees) {
  const double turned = degrees - 360.0 * std::floor(degrees / 360.0);
  return turned > kRounding && turned <= 360.0 ? turned : 360.0;
}

/// The vertex of a face that is not on the edge.
VertexHandle third_vertex(const TetMesh& mesh, HalfFaceHandle h, VertexHandle a, VertexHandle b) {
  for (VertexHandle v : mesh.halfface_vertices(h))
    if (v != a && v != b) return v;
  return {};
}

void close(Wedge& wedge, HalfFaceHandle last) {
  wedge.last = last;
  if (!wedge.positive) wedge.degrees = within_turn(wedge.degrees);
}

}  // namespace

void find_wedges(const TetMesh& mesh, RingPlace start, EdgeWedges& out) {
  out = {false, std::move(out.wedges), std::nullopt, false};
  out.wedges.clear();
  RingPlace at = start;
  Wedge wedge{0, halfface_of(at.cell, at.q), {}, true};
  Wedge whole = wedge;
  bool known = true;
  for (;;) {
    const Turn turn = turn_of(mesh, at);
    known = known && turn.known;
    for (Wedge* part : {&wedge, &whole}) {
      part->degrees += turn.degrees;
      part->positive = part->positive && turn.positive;
    }
    const HalfFaceHandle exit = halfface_of(at.cell, at.p);
    if (mesh.is_constrained(exit)) {
      close(wedge, exit);
      out.wedges.push_back(wedge);
      wedge = {0, mesh.opposite_halfface(exit), {}, true};
    }
    at = mesh.next_in_ring(at);
    if (!at.cell.is_valid()) {
      close(whole, exit);
      out.whole = whole;
      break;
    }
    if (at.cell == start.cell) {
      out.closed = true;
      break;
    }
  }
  if (!known) {
    for (Wedge& part : out.wedges) part.degrees = 360.0;
    if (out.whole) out.whole->degrees = 360.0;
  }
  if (whole.positive || !known) return;
  double sum = 0;
  for (const Wedge& part : out.wedges) sum += part.degrees;
  const double room = out.closed ? 360.0 : out.whole->degrees;
  if (sum < room + 180.0) return;
  out.impossible = true;
  const auto widest =
      std::max_element(out.wedges.begin(), out.wedges.end(), [](const Wedge& a, const Wedge& b) {
        return (a.positive ? 0.0 : a.degrees) < (b.positive ? 0.0 : b.degrees);
      });
  widest->degrees -= 360.0;
}

std::optional<EdgeWedges> wedges_at(const TetMesh& mesh, CellHandle c, int edge) {
  const auto& opposite = kEdgeOpposite[static_cast<std::size_t>(edge)];
  RingPlace at{c, opposite[0], opposite[1]};
  RingPlace start;
  do {
    const HalfFaceHandle behind = halfface_of(at.cell, at.q);
    if (mesh.is_constrained(behind) && !start.cell.is_valid()) start = at;
    if (!mesh.opposite_halfface(behind).is_valid()) {
      start = at;
      break;
    }
    at = mesh.previous_in_ring(at);
  } while (at.cell != c);
  if (!start.cell.is_valid()) return std::nullopt;
  EdgeWedges found;
  find_wedges(mesh, start, found);
  return found;
}

double wedge_ceiling(const TetMesh& mesh, VertexHandle a, VertexHandle b, const Wedge& wedge) {
  if (wedge.degrees <= 0) return wedge.degrees;
  const Vec3 p = mesh.point(third_vertex(mesh, wedge.last, a, b));
  const Vec3 q = mesh.point(third_vertex(mesh, wedge.first, a, b));
  const auto angle = [&](Vec3 x, Vec3 y) {
    return report_value(Metric::kMinDihedral, MinDihedral{}(mesh.point(a), mesh.point(b), x, y));
  };
  return std::max(std::max(angle(p, q), angle(q, p)), 0.5 * wedge.degrees);
}

}  // namespace hfr
