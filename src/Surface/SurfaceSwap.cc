// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, JPDC 73 (2013), SURFACE OPTIMIZATION: a diagonal of the surface is swapped when the worst
// cell of its cluster gets better. The search is Klincsek's over the open ring.
#include "Surface/SurfaceSwap.hh"

#include <algorithm>
#include <limits>

#include "Operators/Klincsek.hh"
#include "Operators/Metrics.hh"

namespace hfr {
namespace {

static_assert(SurfaceSwap<VolumeLength>::kMaxRing + 1 == HFR_MAX_RING);  // vertices of the polygon

/// The open ring of a boundary edge: cell i lies between vertices i and i+1, counter-clockwise about a→b.
struct OpenRing {
  VertexHandle a, b;
  int n_cells = 0;
  RawArray<CellHandle, HFR_MAX_RING> cells;
  RawArray<VertexHandle, HFR_MAX_RING> vertices;
  FixedVector<CellHandle, HFR_MAX_RING> behind;  // for a single cell: the others round its opposite edge
};

/// False when the ring is closed, too large, or a single cell whose opposite edge is on the boundary.
bool gather_open_ring(const TetMesh& mesh, EdgeHandle seed, OpenRing& ring) {
  const CellHandle c(seed.idx() / 6);
  const std::size_t local = seed.idx() % 6;
  const auto& opposite = kEdgeOpposite[local];
  const auto [a, b] = mesh.edge_vertices(seed);
  ring.a = a;
  ring.b = b;
  Ring all;
  if (!mesh.gather_ring({c, opposite[0], opposite[1]}, all) || all.closed || all.size >= HFR_MAX_RING)
    return false;
  ring.n_cells = all.size;
  for (std::size_t i = 0; i < static_cast<std::size_t>(all.size); ++i) {
    const RingPlace at = all.places[i];
    ring.cells[i] = at.cell;
    ring.vertices[i] = mesh.cell(at.cell).v[at.p];
    ring.vertices[i + 1] = mesh.cell(at.cell).v[at.q];
  }
  ring.behind.clear();
  if (all.size > 1) return true;
  const RingPlace only = all.places[0];
  Ring round;
  const auto& ends = kEdgeCorners[local];
  const RingPlace start{only.cell, ends[0], ends[1]};
  // Either order of the ends will do: only the set of cells matters, and gather_ring() begins with `start`.
  if (!mesh.gather_ring(start, round) || !round.closed || round.size > HFR_MAX_RING) return false;
  for (std::size_t i = 1; i < static_cast<std::size_t>(round.size); ++i)
    ring.behind.push_back(round.places[i].cell);
  return true;
}

template <class Visit>
void for_dead(const OpenRing& ring, Visit&& visit) {
  for (CellHandle c : ring.behind) visit(c);
  for (int i = 0; i < ring.n_cells; ++i) visit(ring.cells[static_cast<std::size_t>(i)]);
}

}  // namespace

template <class Metric>
void SurfaceSwap<Metric>::scope(const TetMesh& mesh, Seed seed, Scope& out) const {
  OpenRing ring;
  out.clear();
  if (gather_open_ring(mesh, seed, ring)) for_dead(ring, [&](CellHandle c) { out.push_back(c); });
}

template <class Metric>
auto SurfaceSwap<Metric>::evaluate(const TetMesh& mesh, Seed seed) const -> std::optional<Plan> {
  OpenRing ring;
  if (!gather_open_ring(mesh, seed, ring)) return std::nullopt;
  const auto n = static_cast<std::size_t>(ring.n_cells);
  Plan plan;
  plan.old_worst = std::numeric_limits<double>::infinity();
  for_dead(ring, [&](CellHandle c) { plan.old_worst = std::min(plan.old_worst, quality[c.idx()]); });
  const Vec3 a = mesh.point(ring.a);
  const Vec3 b = mesh.point(ring.b);
  RawArray<Vec3, HFR_MAX_RING> p;
  for (std::size_t i = 0; i <= n; ++i) p[i] = mesh.point(ring.vertices[i]);
  if (n == 1) {
    plan.new_worst = std::numeric_limits<double>::infinity();
    for (CellHandle c : ring.behind) plan.new_worst = std::min(plan.new_worst, quality[c.idx()]);
  } else {
    RingTriangulation table(ring.n_cells + 1);
    plan.new_worst = table.solve(plan.old_worst, ring_value(metric, p, a, b));
    if (plan.new_worst > plan.old_worst) table.preorder(plan.apex.data());
  }
  if (!(plan.new_worst > plan.old_worst)) return std::nullopt;
  // Cell (a, b, p0, p1) is positive, so that its boundary face is (b, a, p0) seen from outside.
  const std::array<std::array<VertexHandle, 3>, 2> faces = {
      {{ring.b, ring.a, ring.vertices[0]}, {ring.a, ring.b, ring.vertices[n]}}};
  const std::array<Triangle, 2> dead = {{{b, a, p[0]}, {a, b, p[n]}}};
  const std::array<Triangle, 2> born = {{{p[n], p[0], b}, {p[0], p[n], a}}};
  if (!surface->keeps_shape(faces, dead, born)) return std::nullopt;
  plan.seed = seed;
  plan.edge = {ring.a, ring.b};
  plan.n_dead = static_cast<std::uint32_t>(n + ring.behind.size());
  plan.n_born = static_cast<std::uint32_t>(n == 1 ? ring.behind.size() : 2 * (n - 1));
  return plan;
}

template <class Metric>
void SurfaceSwap<Metric>::commit(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  OpenRing ring;
  gather_open_ring(mesh, plan.seed, ring);
  out.clear();
  out.surface_is_held = true;
  for_dead(ring, [&](CellHandle c) { out.dead.push_back(c); });
  for (CellHandle c : ring.behind) out.born.push_back(mesh.cell(c).v);
  if (ring.n_cells == 1) return;
  append_ring_cells(ring.vertices, ring.a, ring.b, ring.n_cells, plan.apex.data(), out);
}

template <class Metric>
Tet SurfaceSwap<Metric>::identity(const TetMesh& mesh, Seed seed) const {
  return edge_identity(mesh, seed);
}

HFR_INSTANTIATE_FOR_METRICS(SurfaceSwap)

}  // namespace hfr
