// SPDX-License-Identifier: BSD-3-Clause
// G. T. Klincsek, Minimal triangulations of polygonal domains, 1980; applied to edge removal by Shewchuk, Two
// discrete optimization algorithms for the topological improvement of tetrahedral meshes, 2002.
#include "Operators/EdgeRemoval.hh"

#include <algorithm>
#include <limits>

#include "Operators/EdgeRing.hh"
#include "Operators/Klincsek.hh"
#include "Operators/Metrics.hh"

namespace hfr {

static_assert(EdgeRemoval<VolumeLength>::kMaxRing == HFR_MAX_RING);

namespace {

/// True where no triangulation of the ring is better: at the side of the polygon that a cell has, its
/// dihedral is shared out between the two new cells there, one of which has no more than half of it. Looks at
/// no cell whose angles are twice those of the worst. The margin is for the rounding of this and of the
/// metric, so that what is refused is what the search would refuse.
bool halves_are_worse(const TetMesh& mesh, const EdgeRing& ring, std::span<const double> quality,
                      std::span<const Vec3> p, double old_worst) {
  constexpr double kLeast = 1e-8, kMargin = 1 - 1e-6;
  if (!(old_worst > kLeast)) return false;
  const Vec3 a = mesh.point(ring.a);
  const Vec3 b = mesh.point(ring.b);
  const auto n = static_cast<std::size_t>(ring.n_cells);
  for (std::size_t i = 0; i < n; ++i) {
    if (!(quality[ring.cells[i].idx()] < 4 * old_worst)) continue;
    const double half =
        hfr_half_dihedral_sin2(to_real3(a), to_real3(b), to_real3(p[i]), to_real3(p[(i + 1) % n]));
    if (half < kMargin * old_worst) return true;
  }
  return false;
}

}  // namespace

template <class Metric>
void EdgeRemoval<Metric>::scope(const TetMesh& mesh, Seed seed, Scope& out) const {
  EdgeRing ring;
  out.clear();
  gather_closed_ring(mesh, seed, ring);
  for (CellHandle c : ring) out.push_back(c);
}

template <class Metric>
std::optional<typename EdgeRemoval<Metric>::Plan> EdgeRemoval<Metric>::evaluate(const TetMesh& mesh,
                                                                                Seed seed) const {
  EdgeRing ring;
  if (!gather_closed_ring(mesh, seed, ring)) return std::nullopt;
  const auto n = static_cast<std::size_t>(ring.n_cells);
  double old_worst = std::numeric_limits<double>::infinity();
  RawArray<Vec3, HFR_MAX_RING> p;
  for (std::size_t i = 0; i < n; ++i) {
    old_worst = std::min(old_worst, quality[ring.cells[i].idx()]);
    p[i] = mesh.point(ring.vertices[i]);
  }
  if constexpr (kMeasuresAngles<Metric>)
    if (halves_are_worse(mesh, ring, quality, p, old_worst)) return std::nullopt;
  RingTriangulation table(ring.n_cells);
  const double new_worst =
      table.solve(old_worst, ring_value(metric, p, mesh.point(ring.a), mesh.point(ring.b)));
  if (!(new_worst > old_worst)) return std::nullopt;
  Plan plan;
  plan.old_worst = old_worst;
  plan.new_worst = new_worst;
  plan.n_removed = static_cast<std::uint32_t>(n);
  plan.n_created = static_cast<std::uint32_t>(2 * (n - 2));
  plan.seed = seed;
  plan.ring = static_cast<std::uint8_t>(n);
  table.preorder(plan.apex.data());
  return plan;
}

template <class Metric>
void EdgeRemoval<Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  EdgeRing ring;
  gather_closed_ring(mesh, plan.seed, ring);
  out.clear();
  for (CellHandle c : ring) out.removed.push_back(c);
  append_ring_cells(ring.vertices, ring.a, ring.b, ring.n_cells - 1, plan.apex.data(), out);
}

template <class Metric>
Tet EdgeRemoval<Metric>::identity(const TetMesh& mesh, Seed seed) const {
  return edge_identity(mesh, seed);
}

HFR_INSTANTIATE_FOR_METRICS(EdgeRemoval)

}  // namespace hfr
