// SPDX-License-Identifier: BSD-3-Clause
// Renumbering of vertices and cells, and the compaction that is one case of it.
#include "HalfFace/TetMesh.hh"
#include "HalfFace/TupleUse.hh"

namespace hfr {
namespace {

/// values[i] moves to place to[i]; values whose place is invalid are dropped.
template <class Kind, class T>
void permute(par::Policy policy, const std::vector<Handle<Kind>>& to, std::size_t n_new,
             std::vector<T>& values) {
  if (values.empty()) return;
  std::vector<T> moved(n_new);
  par::for_each(policy, values.size(), [&](std::size_t i) {
    if (to[i].is_valid()) moved[to[i].idx()] = std::move(values[i]);
  });
  values = std::move(moved);
}

/// Old → new with the order of the kept ones kept.
template <class H, class Keep>
std::vector<H> close_up(std::size_t n, std::size_t& n_new, Keep&& keep) {
  std::vector<H> to(n);
  n_new = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (keep(i)) to[i] = H(n_new++);
  return to;
}

template <std::size_t N, class T>
void rename_used(const TetMesh& mesh, const std::vector<VertexHandle>& to, TupleMap<N, T>& map) {
  if (map.empty()) return;
  const std::vector<std::uint8_t> used = used_entries(mesh, map);
  std::size_t i = 0;
  map.rename_vertices([&](VertexHandle v) { return to[v.idx()]; },
                      [&](const auto&) { return used[i++] != 0; });
}

}  // namespace

void TetMesh::renumber(const GarbageMap& map, std::size_t n_vertices, std::size_t n_cells,
                       par::Policy policy) {
  rename_used(*this, map.vertices, labels_.faces);
  rename_used(*this, map.vertices, labels_.edges);
  rename_used(*this, map.vertices, locks_.faces);
  rename_used(*this, map.vertices, locks_.edges);
  properties_.renumber(*this, map.vertices, n_vertices, map.cells, n_cells);
  permute(policy, map.vertices, n_vertices, labels_.vertices);
  permute(policy, map.vertices, n_vertices, points_);
  permute(policy, map.vertices, n_vertices, vertex_status_);
  permute(policy, map.cells, n_cells, regions_);
  permute(policy, map.cells, n_cells, cell_status_);
  std::vector<Cell> cells(n_cells);
  par::for_each(policy, cells_.size(), [&](std::size_t i) {
    if (!map.cells[i].is_valid()) return;
    Cell& to = cells[map.cells[i].idx()];
    for (std::size_t k = 0; k < 4; ++k) {
      to.v[k] = map.vertices[cells_[i].v[k].idx()];
      const HalfFaceHandle m = cells_[i].mate[k];
      if (m.is_valid()) to.mate[k] = halfface_of(map.cells[cell_of(m).idx()], corner_of(m));
    }
  });
  cells_ = std::move(cells);
  hand_index_state_ = kVoid;
  free_cells_.clear();
  n_deleted_vertices_ = 0;
  incident_cell_.assign(n_vertices, CellHandle());
  for (std::size_t i = n_cells; i-- > 0;)  // downwards, so that the smallest cell stays
    for (VertexHandle v : cells_[i].v) incident_cell_[v.idx()] = CellHandle(i);
}

GarbageMap TetMesh::collect_garbage(GarbageOptions options) {
  GarbageMap map;
  std::size_t n_vertices = 0;
  std::size_t n_cells = 0;
  map.vertices = close_up<VertexHandle>(points_.size(), n_vertices, [&](std::size_t i) {
    return (vertex_status_[i] & kDeleted) == 0 &&
           !(options.drop_unused_vertices && !incident_cell_[i].is_valid());
  });
  map.cells =
      close_up<CellHandle>(cells_.size(), n_cells, [&](std::size_t i) { return !is_deleted(CellHandle(i)); });
  renumber(map, n_vertices, n_cells, options.policy);
  return map;
}

}  // namespace hfr
