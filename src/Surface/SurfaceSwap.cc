// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, JPDC 73 (2013), SURFACE OPTIMIZATION: a diagonal of the surface is swapped when the worst
// cell of its cluster gets better. The search is Klincsek's over the open ring.
#include "Surface/SurfaceSwap.hh"

#include <algorithm>
#include <limits>

#include "Operators/EdgeRing.hh"
#include "Operators/Klincsek.hh"
#include "Operators/Metrics.hh"

namespace hfr {
namespace {

static_assert(SurfaceSwap<VolumeLength>::kMaxRing + 1 == HFR_MAX_RING);  // vertices of the polygon

struct SwapRing : EdgeRing {
  FixedVector<CellHandle, HFR_MAX_RING> behind;  // for a single cell: the others round its opposite edge
};

/// False when the ring is closed, too large, or a single cell whose opposite edge is on the boundary.
bool gather(const TetMesh& mesh, EdgeHandle seed, SwapRing& ring) {
  if (!gather_open_ring(mesh, seed, ring)) return false;
  ring.behind.clear();
  if (ring.n_cells > 1) return true;
  const auto& ends = kEdgeCorners[seed.idx() % 6];
  EdgeFan round;
  // Either order of the ends will do: only the set of cells matters, and the fan begins with the single one.
  if (!gather_closed_fan(mesh, {ring.cells[0], ends[0], ends[1]}, round)) return false;
  for (CellHandle c : std::span(round.begin() + 1, round.end())) ring.behind.push_back(c);
  return true;
}

template <class Visit>
void for_removed(const SwapRing& ring, Visit&& visit) {
  for (CellHandle c : ring.behind) visit(c);
  for (CellHandle c : ring) visit(c);
}

}  // namespace

template <class Metric>
void SurfaceSwap<Metric>::scope(const TetMesh& mesh, Seed seed, Scope& out) const {
  SwapRing ring;
  out.clear();
  if (gather(mesh, seed, ring)) for_removed(ring, [&](CellHandle c) { out.push_back(c); });
}

template <class Metric>
auto SurfaceSwap<Metric>::evaluate(const TetMesh& mesh, Seed seed) const -> std::optional<Plan> {
  SwapRing ring;
  if (!gather(mesh, seed, ring)) return std::nullopt;
  const auto n = static_cast<std::size_t>(ring.n_cells);
  Plan plan;
  plan.old_worst = std::numeric_limits<double>::infinity();
  for_removed(ring, [&](CellHandle c) { plan.old_worst = std::min(plan.old_worst, quality[c.idx()]); });
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
  const std::array<Triangle, 2> removed = {{{b, a, p[0]}, {a, b, p[n]}}};
  const std::array<Triangle, 2> created = {{{p[n], p[0], b}, {p[0], p[n], a}}};
  if (!surface->keeps_shape(faces, removed, created)) return std::nullopt;
  plan.seed = seed;
  plan.edge = {ring.a, ring.b};
  plan.n_removed = static_cast<std::uint32_t>(n + ring.behind.size());
  plan.n_created = static_cast<std::uint32_t>(n == 1 ? ring.behind.size() : 2 * (n - 1));
  return plan;
}

template <class Metric>
void SurfaceSwap<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  SwapRing ring;
  gather(mesh, plan.seed, ring);
  out.clear();
  out.surface_is_held = true;
  for_removed(ring, [&](CellHandle c) { out.removed.push_back(c); });
  for (CellHandle c : ring.behind) out.created.push_back(mesh.cell(c).v);
  if (ring.n_cells == 1) return;
  append_ring_cells(ring.vertices, ring.a, ring.b, ring.n_cells, plan.apex.data(), out);
}

template <class Metric>
Tet SurfaceSwap<Metric>::identity(const TetMesh& mesh, Seed seed) const {
  return edge_identity(mesh, seed);
}

HFR_INSTANTIATE_FOR_METRICS(SurfaceSwap)

}  // namespace hfr
