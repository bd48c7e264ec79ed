// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_TRANSFER_TWO_MESHES_HH
#define HFR_UNITTESTS_TRANSFER_TWO_MESHES_HH

#include <gtest/gtest.h>

#include <vector>

#include "HalfFace/Generate.hh"
#include "Transfer/Edits.hh"

namespace hfr::test {

/// A mesh and what was made of it by hand, without the layers above: some edges are split, some vertices are
/// moved, and a few edges are collapsed. The new one is without gaps.
struct TwoMeshes {
  TetMesh old, now;
  MeshMaps maps;

  explicit TwoMeshes(Index n = 5, double jitter = 0.15, std::uint64_t seed = 1)
      : TwoMeshes(generate::jittered_box({n, n, n}, jitter, seed)) {}

  explicit TwoMeshes(const generate::Arrays& arrays) {
    old = build(arrays.points, arrays.cells);
    now = old;
    std::vector<VertexHandle> source(old.n_vertices());
    for (std::size_t i = 0; i < source.size(); ++i) source[i] = VertexHandle(i);
    std::vector<CellHandle> cut;
    for (const std::size_t at : {17U, 201U, 350U, 420U}) {
      const EdgeHandle e = now.edge_in_cell(CellHandle(at % now.n_cells()), 2);
      const VertexHandle a = now.edge_vertices(e)[0];
      const VertexHandle v = now.split_edge(e);
      source.resize(v.idx() + 1);
      source[v.idx()] = a;
    }
    for (VertexHandle v : now.vertices()) {
      if (now.is_boundary(v) || v.idx() % 5 != 0) continue;
      now.set_point(v, now.point(v) + Vec3{0.01, -0.012, 0.008});
    }
    std::size_t collapsed = 0;
    for (std::size_t i = 0; i < old.n_vertices() && collapsed < 3; ++i) {
      const VertexHandle v(i * 13 % old.n_vertices());
      if (now.is_deleted(v) || now.is_boundary(v)) continue;
      const auto edges = now.outgoing_halfedges(v);
      const HalfEdgeHandle e = *edges.begin();
      if (!now.is_collapse_ok(e)) continue;
      now.collapse_edge(e);
      ++collapsed;
    }
    const GarbageMap garbage = now.collect_garbage();
    const auto vertex_to = [&](VertexHandle v) {
      return garbage.vertices.empty() ? v : garbage.vertices[v.idx()];
    };
    const auto cell_to = [&](CellHandle c) { return garbage.cells.empty() ? c : garbage.cells[c.idx()]; };
    maps.vertices.assign(old.n_vertices(), {});
    maps.old_vertices.assign(now.n_vertices(), {});
    maps.sources.assign(now.n_vertices(), {});
    for (std::size_t i = 0; i < source.size(); ++i) {
      const VertexHandle v = vertex_to(VertexHandle(i));
      if (!v.is_valid()) continue;
      maps.sources[v.idx()] = source[i];
      if (i >= old.n_vertices()) continue;
      maps.vertices[i] = v;
      maps.old_vertices[v.idx()] = VertexHandle(i);
    }
    maps.cells.assign(old.n_cells(), {});
    maps.old_cells.assign(now.n_cells(), {});
    for (std::size_t i = 0; i < old.n_cells(); ++i) {
      const CellHandle c = cell_to(CellHandle(i));
      if (!c.is_valid()) continue;
      bool same = true;
      for (std::size_t k = 0; k < 4; ++k)
        same = same && maps.vertices[old.cell_vertices(CellHandle(i))[k].idx()] == now.cell_vertices(c)[k];
      if (!same) continue;
      maps.cells[i] = c;
      maps.old_cells[c.idx()] = CellHandle(i);
    }
  }

  Edits edits(par::Policy policy = {}) const {
    return make_edits(std::make_shared<TetMesh>(old), now, maps, policy);
  }
};

}  // namespace hfr::test

#endif
