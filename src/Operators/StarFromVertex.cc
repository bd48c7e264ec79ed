// SPDX-License-Identifier: BSD-3-Clause
// D'Amato & Venere, JPDC 73 (2013), section 3.2, CLUSTER OPTIMIZATION.
#include "Operators/StarFromVertex.hh"

#include <algorithm>
#include <limits>

#include "Operators/Metrics.hh"

namespace hfr {
namespace {

using Face = std::array<VertexHandle, 3>;

/// The outer surface of a set of cells, each triangle as its cell sees it.
using Surface = FixedVector<Face, 4 * Star::kCapacity>;

Surface surface_of(const TetMesh& mesh, std::span<const CellHandle> cells) {
  Surface surface;
  for (CellHandle c : cells) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (!m.is_valid() || std::find(cells.begin(), cells.end(), cell_of(m)) == cells.end())
        surface.push_back(mesh.halfface_vertices(h));
    }
  }
  return surface;
}

bool has_vertex(const Face& f, VertexHandle v) { return f[0] == v || f[1] == v || f[2] == v; }

template <class Seed>
EdgeHandle edge_of(const Seed& seed) {
  return EdgeHandle(6 * seed.cell.idx() + seed.local);
}

template <Cluster kCluster, class Seed>
void gather(const TetMesh& mesh, Seed seed, Scope& out) {
  out.clear();
  if constexpr (kCluster == Cluster::kEdge) {
    const bool closed = mesh.walk_ring(seed.cell, seed.local, [&](CellHandle c, VertexHandle, VertexHandle) {
      if (out.full()) return false;
      out.push_back(c);
      return true;
    });
    if (!closed) out.clear();
  } else if constexpr (kCluster == Cluster::kFace) {
    const HalfFaceHandle m = mesh.opposite_halfface(halfface_of(seed.cell, seed.local));
    if (!m.is_valid()) return;
    out.push_back(seed.cell);
    out.push_back(cell_of(m));
  } else {
    Star star;
    mesh.gather_star(mesh.cell(seed.cell).v[seed.local], star);
    for (int i = 0; i < star.size; ++i) out.push_back(star.cells[static_cast<std::size_t>(i)]);
  }
}

/// True for an apex that gives the cells that are there already: an end of the edge, a corner of the face.
/// Rounding differs with the order of vertices, so such a star may look better by the last bit.
template <Cluster kCluster, class Seed>
bool rebuilds([[maybe_unused]] const TetMesh& mesh, [[maybe_unused]] Seed seed,
              [[maybe_unused]] VertexHandle apex) {
  if constexpr (kCluster == Cluster::kEdge) {
    const auto [a, b] = mesh.edge_vertices(edge_of(seed));
    return a == apex || b == apex;
  } else if constexpr (kCluster == Cluster::kFace) {
    return has_vertex(mesh.halfface_vertices(halfface_of(seed.cell, seed.local)), apex);
  } else {
    return false;
  }
}

}  // namespace

template <Cluster kCluster, class Metric>
void StarFromVertex<kCluster, Metric>::scope(const TetMesh& mesh, Seed seed, Scope& out) const {
  gather<kCluster>(mesh, seed, out);
}

template <Cluster kCluster, class Metric>
auto StarFromVertex<kCluster, Metric>::evaluate(const TetMesh& mesh, Seed seed) const -> std::optional<Plan> {
  if constexpr (kCluster == Cluster::kNode) {
    const VertexHandle v = mesh.cell(seed.cell).v[seed.local];
    if (frozen[v.idx()] || mesh.labels().vertex(v) != 0) return std::nullopt;
  }
  Scope cells;
  gather<kCluster>(mesh, seed, cells);
  if (cells.empty()) return std::nullopt;
  Plan plan;
  plan.seed = seed;
  plan.n_removed = static_cast<std::uint32_t>(cells.size());
  plan.removes_vertex = kCluster == Cluster::kNode;
  plan.old_worst = std::numeric_limits<double>::infinity();
  for (CellHandle c : cells) plan.old_worst = std::min(plan.old_worst, quality[c.idx()]);
  plan.new_worst = plan.old_worst;

  const Surface surface = surface_of(mesh, cells);
  FixedVector<VertexHandle, 12 * Star::kCapacity> vertices;
  for (const Face& f : surface)
    for (VertexHandle v : f) vertices.push_back(v);
  std::sort(vertices.begin(), vertices.end());
  vertices.resize(static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) - vertices.begin()));

  const auto try_apex = [&](VertexHandle apex, Vec3 p, double floor) {
    double worst = std::numeric_limits<double>::infinity();
    std::uint32_t n_created = 0;
    for (const Face& f : surface) {
      if (has_vertex(f, apex)) continue;
      ++n_created;
      worst = std::min(worst, metric(mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2]), p));
      if (!(worst > floor)) return;
    }
    if (n_created == 0) return;
    plan.new_worst = worst;
    plan.apex = apex;
    plan.n_created = n_created;
  };
  if (reconnect) {
    for (VertexHandle apex : vertices)
      if (!rebuilds<kCluster>(mesh, seed, apex)) try_apex(apex, mesh.point(apex), plan.new_worst);
  }
  if (insert) {
    for (VertexHandle v : vertices) plan.middle = plan.middle + mesh.point(v);
    plan.middle = (1.0 / static_cast<double>(vertices.size())) * plan.middle;
    // Smaller inverted cells would look better in some metrics, and be cut again without end.
    try_apex(Cavity::kNewVertex, plan.middle, std::max(plan.new_worst, 0.0));
  }
  if (!plan.apex.is_valid()) return std::nullopt;
  plan.adds_vertex = plan.apex == Cavity::kNewVertex;
  return plan;
}

template <Cluster kCluster, class Metric>
void StarFromVertex<kCluster, Metric>::cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
  Scope cells;
  gather<kCluster>(mesh, plan.seed, cells);
  out.clear();
  for (CellHandle c : cells) out.removed.push_back(c);
  for (const Face& f : surface_of(mesh, cells))
    if (!has_vertex(f, plan.apex)) out.created.push_back({f[0], f[1], f[2], plan.apex});
  if (plan.removes_vertex) out.removed_vertex = mesh.cell(plan.seed.cell).v[plan.seed.local];
  if (plan.adds_vertex) out.new_vertex = plan.middle;
}

template <Cluster kCluster, class Metric>
Tet StarFromVertex<kCluster, Metric>::identity(const TetMesh& mesh, Seed seed) const {
  Tet names;
  if constexpr (kCluster == Cluster::kEdge) {
    names = edge_identity(mesh, edge_of(seed));
  } else if constexpr (kCluster == Cluster::kFace) {
    const auto f = mesh.halfface_vertices(halfface_of(seed.cell, seed.local));
    names = {f[0], f[1], f[2], VertexHandle()};
  } else {
    names = {mesh.cell(seed.cell).v[seed.local], VertexHandle(), VertexHandle(), VertexHandle()};
  }
  std::sort(names.begin(), names.end());
  return names;
}

#define HFR_INSTANTIATE(Metric)                           \
  template struct StarFromVertex<Cluster::kEdge, Metric>; \
  template struct StarFromVertex<Cluster::kFace, Metric>; \
  template struct StarFromVertex<Cluster::kNode, Metric>;
HFR_INSTANTIATE(VolumeLength)
HFR_INSTANTIATE(Untangling)
HFR_INSTANTIATE(MinSine2)
HFR_INSTANTIATE(MinDihedral)
HFR_INSTANTIATE(CustomMetric)

}  // namespace hfr
