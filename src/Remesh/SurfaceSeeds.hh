// SPDX-License-Identifier: BSD-3-Clause
// Private: seeds of passes over the surface, of a mesh or of a part of one.
#ifndef HFR_REMESH_SURFACE_SEEDS_HH
#define HFR_REMESH_SURFACE_SEEDS_HH

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Scheduler/Seeds.hh"
#include "Scheduler/Workspace.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr {

/// About how long SurfaceCollapse::may_gain() takes.
inline constexpr double kMayGainNanoseconds = 1'000;

/// Vertices of the surface in the listed cells that may move in their facet or along their curve, ascending.
inline std::vector<VertexHandle> free_surface_vertices(const TetMesh& mesh, const SurfaceMesh& surface,
                                                       const Workspace& work, const Worklist& list) {
  std::vector<VertexHandle> vertices;
  std::vector<std::uint8_t> seen(mesh.n_vertices(), 0);
  for (Index c : list.cells()) {
    for (VertexHandle v : mesh.cell(CellHandle(c)).v) {
      // The surface is frozen for what works inside.
      if (!work.frozen[v.idx()] || std::exchange(seen[v.idx()], std::uint8_t{1}) != 0) continue;
      const SurfaceKind kind = surface.motion_constraint(v).kind;
      if (kind == SurfaceKind::kFacet || kind == SurfaceKind::kCurve) vertices.push_back(v);
    }
  }
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

/// Edges of the boundary in the listed cells that allow(a, b) lets by, each from the smallest listed cell at
/// it, if names(cell); with `inside` those between vertices of the surface that the boundary does not have.
/// `before(a, b)`: the order of cells, where it is not that of their handles.
template <class Allow, class Names, class Before = std::less<CellHandle>>
std::vector<EdgeHandle> surface_edges(const TetMesh& mesh, const Workspace& work, const Worklist& list,
                                      bool inside, Allow&& allow, Names&& names, Before&& before = {}) {
  std::vector<EdgeHandle> seeds;
  for (Index i : list.cells()) {
    const CellHandle c(i);
    if (!names(c)) continue;
    const auto& v = mesh.cell(c).v;
    for (Index e = 0; e < 6; ++e) {
      const VertexHandle a = v[kEdgeCorners[e][0]];
      const VertexHandle b = v[kEdgeCorners[e][1]];
      if (!work.frozen[a.idx()] || !work.frozen[b.idx()]) continue;  // not of the surface
      bool smallest = true;
      const auto look = [&](CellHandle other, VertexHandle, VertexHandle) {
        smallest = smallest && (!list.has(other) || !before(other, c));
        return smallest;
      };
      const bool closed = mesh.walk_ring(c, static_cast<int>(e), look);
      if (!smallest || closed != inside) continue;
      if (!closed) mesh.walk_ring_back(c, static_cast<int>(e), look);
      if (smallest && allow(a, b)) seeds.push_back(EdgeHandle(6 * i + e));
    }
  }
  return seeds;
}

}  // namespace hfr

#endif
