// SPDX-License-Identifier: BSD-3-Clause
// SurfaceSwap's search, once for each region.
#include "Surface/InterfaceSwap.hh"

#include <algorithm>
#include <limits>

#include "Operators/EdgeRing.hh"
#include "Operators/Klincsek.hh"
#include "Operators/Metrics.hh"

namespace hfr {
namespace {

static_assert(InterfaceSwap<VolumeLength>::kMaxSide + 1 == HFR_MAX_RING);  // vertices of the polygon

/// The rings on both sides of the edge. False where gather_two_sided_ring() is, and for a side of a single
/// cell.
bool gather(const TetMesh& mesh, EdgeHandle seed, TwoSidedRing& two) {
  return gather_two_sided_ring(mesh, seed, two) && two.sides[0].n_cells > 1 && two.sides[1].n_cells > 1;
}

}  // namespace

template <class Metric>
void InterfaceSwap<Metric>::scope(const TetMesh& mesh, Seed seed, Scope& out) const {
  TwoSidedRing two;
  out.clear();
  if (!gather(mesh, seed, two)) return;
  for (const EdgeFan& side : two.sides)
    for (CellHandle c : side) out.push_back(c);
}

template <class Metric>
auto InterfaceSwap<Metric>::evaluate(const TetMesh& mesh, Seed seed) const -> std::optional<Plan> {
  TwoSidedRing two;
  if (!gather(mesh, seed, two)) return std::nullopt;
  Plan plan;
  plan.old_worst = std::numeric_limits<double>::infinity();
  for (const EdgeFan& side : two.sides)
    for (CellHandle c : side) plan.old_worst = std::min(plan.old_worst, quality[c.idx()]);
  plan.new_worst = std::numeric_limits<double>::infinity();
  const Vec3 a = mesh.point(two.a);
  const Vec3 b = mesh.point(two.b);
  for (std::size_t s = 0; s < 2; ++s) {
    const EdgeFan& side = two.sides[s];
    RawArray<Vec3, HFR_MAX_RING> p;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(side.n_cells); ++i)
      p[i] = mesh.point(side.vertices[i]);
    RingTriangulation table(side.n_cells + 1);
    const double worst = table.solve(plan.old_worst, ring_value(metric, p, a, b));
    if (!(worst > plan.old_worst)) return std::nullopt;
    table.preorder(plan.apex[s].data());
    plan.new_worst = std::min(plan.new_worst, worst);
  }
  const EdgeFan& inner = two.sides[0];  // interface faces are seen from the larger region
  const auto n = static_cast<std::size_t>(inner.n_cells);
  const VertexHandle p = inner.vertices[0];
  const VertexHandle q = inner.vertices[n];
  const Vec3 at_p = mesh.point(p);
  const Vec3 at_q = mesh.point(q);
  const std::array<std::array<VertexHandle, 3>, 2> faces = {{{two.b, two.a, p}, {two.a, two.b, q}}};
  const std::array<Triangle, 2> removed = {{{b, a, at_p}, {a, b, at_q}}};
  const std::array<Triangle, 2> created = {{{at_q, at_p, b}, {at_p, at_q, a}}};
  if (!surface->keeps_shape(faces, removed, created)) return std::nullopt;
  plan.seed = seed;
  plan.edge = {two.a, two.b};
  plan.n_removed_first = static_cast<std::uint16_t>(n);
  plan.n_created_first = static_cast<std::uint16_t>(2 * (n - 1));
  const auto m = static_cast<std::size_t>(two.sides[1].n_cells);
  plan.n_removed = static_cast<std::uint32_t>(n + m);
  plan.n_created = static_cast<std::uint32_t>(2 * (n + m - 2));
  return plan;
}

template <class Metric>
void InterfaceSwap<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  TwoSidedRing two;
  gather(mesh, plan.seed, two);
  out.clear();
  out.surface_is_held = true;
  out.n_removed_first = plan.n_removed_first;
  out.n_created_first = plan.n_created_first;
  for (std::size_t s = 0; s < 2; ++s) {
    const EdgeFan& side = two.sides[s];
    for (CellHandle c : side) out.removed.push_back(c);
    append_ring_cells(side.vertices, two.a, two.b, side.n_cells, plan.apex[s].data(), out);
  }
}

template <class Metric>
Tet InterfaceSwap<Metric>::identity(const TetMesh& mesh, Seed seed) const {
  return edge_identity(mesh, seed);
}

HFR_INSTANTIATE_FOR_METRICS(InterfaceSwap)

}  // namespace hfr
