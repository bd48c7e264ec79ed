// SPDX-License-Identifier: BSD-3-Clause
// Renumbering of vertices and cells, and the compaction that is one case of it.
#include <algorithm>

#include "HalfFace/TetMesh.hh"
#include "HalfFace/TupleUse.hh"
#include "HalfFace/Writer.hh"

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
std::vector<H> close_up(par::Policy policy, std::size_t n, std::size_t& n_new, Keep&& keep) {
  std::vector<H> to(n);
  const int n_parts = par::thread_count(policy, n);
  std::vector<std::size_t> next(static_cast<std::size_t>(n_parts), 0);  // of each part
  par::parts(n_parts, [&](int part) {
    std::size_t n_kept = 0;
    par::for_part(n, n_parts, part, [&](std::size_t i) {
      if (keep(i)) to[i] = H(n_kept++);
    });
    next[static_cast<std::size_t>(part)] = n_kept;
  });
  n_new = par::exclusive_scan(std::span(next));
  par::parts(n_parts, [&](int part) {
    const std::size_t first = next[static_cast<std::size_t>(part)];
    if (first == 0) return;
    par::for_part(n, n_parts, part, [&](std::size_t i) {
      if (to[i].is_valid()) to[i] = H(to[i].idx() + first);
    });
  });
  return to;
}

/// The same where the order of what is kept stays: in place, so that nothing is allocated, and what was
/// reserved is there the next time. `gap`: the first that goes.
template <class Kind, class T>
void close_gaps(const std::vector<Handle<Kind>>& to, std::size_t gap, std::size_t n_new,
                std::vector<T>& values) {
  if (values.empty()) return;
  for (std::size_t i = gap; i < to.size(); ++i)
    if (to[i].is_valid()) values[to[i].idx()] = std::move(values[i]);
  values.resize(n_new);
  constexpr std::size_t kLargestSlack = 4;  // of so many
  if (values.capacity() - n_new > n_new / kLargestSlack + kLargestSlack) values.shrink_to_fit();
}

/// Of a list from close_up().
template <class H>
std::size_t first_gap(const std::vector<H>& to, std::size_t n_new) {
  if (n_new == to.size()) return n_new;
  std::size_t low = 0, high = to.size() - 1;  // valid with its own index below low, not so from high on
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (to[middle].is_valid() && to[middle].idx() == middle)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

Cell renamed(const Cell& cell, const GarbageMap& map) {
  Cell now;
  for (std::size_t k = 0; k < 4; ++k) {
    now.v[k] = map.vertices[cell.v[k].idx()];
    const HalfFaceHandle m = cell.mate[k];
    if (m.is_valid()) now.mate[k] = halfface_of(map.cells[cell_of(m).idx()], corner_of(m));
  }
  return now;
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

/// All that hangs on handles but the arrays of vertices and cells.
void TetMesh::renumber_attached(const GarbageMap& map, std::size_t n_vertices, std::size_t n_cells) {
  rename_used(*this, map.vertices, labels_.faces);
  rename_used(*this, map.vertices, labels_.edges);
  rename_used(*this, map.vertices, locks_.faces);
  rename_used(*this, map.vertices, locks_.edges);
  properties_.renumber(*this, map.vertices, n_vertices, map.cells, n_cells);
  hand_index_state_ = kVoid;
}

void TetMesh::find_incident_cells(par::Policy policy) {
  incident_cell_.assign(points_.size(), CellHandle());
  par::for_targets(policy, cells_.size(), points_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = cells_.size(); i-- > 0;)  // downwards, so that the smallest cell stays
      for (VertexHandle v : cells_[i].v)
        if (v.idx() >= begin && v.idx() < end) incident_cell_[v.idx()] = CellHandle(i);
  });
}

void TetMesh::renumber(const GarbageMap& map, std::size_t n_vertices, std::size_t n_cells,
                       par::Policy policy) {
  renumber_attached(map, n_vertices, n_cells);
  permute(policy, map.vertices, n_vertices, labels_.vertices);
  permute(policy, map.vertices, n_vertices, points_);
  permute(policy, map.vertices, n_vertices, vertex_status_);
  permute(policy, map.cells, n_cells, regions_);
  permute(policy, map.cells, n_cells, cell_status_);
  std::vector<Cell> cells;
  cells.reserve(std::max(n_cells, cells_.capacity()));  // what was reserved for more is there afterwards
  cells.resize(n_cells);
  par::for_each(policy, cells_.size(), [&](std::size_t i) {
    if (map.cells[i].is_valid()) cells[map.cells[i].idx()] = renamed(cells_[i], map);
  });
  cells_ = std::move(cells);
  free_cells_.clear();
  n_deleted_vertices_.n = 0;
  find_incident_cells(policy);
}

void TetMesh::Writer::open_gaps(std::span<const VertexHandle> to, std::size_t n) {
  TetMesh& mesh = mesh_;
  const auto all = [](const auto&) { return true; };
  const auto renamed = [&](VertexHandle v) { return to[v.idx()]; };
  mesh.labels_.faces.rename_vertices(renamed, all);
  mesh.labels_.edges.rename_vertices(renamed, all);
  mesh.locks_.faces.rename_vertices(renamed, all);
  mesh.locks_.edges.rename_vertices(renamed, all);
  if (!mesh.labels_.vertices.empty()) hfr::open_gaps(to, n, 0, mesh.labels_.vertices);
  hfr::open_gaps(to, n, Vec3{}, mesh.points_);
  hfr::open_gaps(to, n, CellHandle(), mesh.incident_cell_);
  hfr::open_gaps(to, n, std::uint8_t{0}, mesh.vertex_status_);
  if (!mesh.properties_.vertices.empty()) {
    std::vector<Index> places;
    for (VertexHandle v : to) places.push_back(v.idx());
    for (const auto& p : mesh.properties_.vertices) p->permute(places, n);
  }
  for (Cell& cell : mesh.cells_)
    for (VertexHandle& v : cell.v)
      if (v.is_valid()) v = to[v.idx()];
  mesh.hand_index_state_ = kVoid;
}

GarbageMap TetMesh::collect_garbage(GarbageOptions options) {
  GarbageMap map;
  std::size_t n_vertices = 0;
  std::size_t n_cells = 0;
  map.vertices = close_up<VertexHandle>(options.policy, points_.size(), n_vertices, [&](std::size_t i) {
    return (vertex_status_[i] & kDeleted) == 0 &&
           !(options.drop_unused_vertices && !incident_cell_[i].is_valid());
  });
  map.cells = close_up<CellHandle>(options.policy, cells_.size(), n_cells,
                                   [&](std::size_t i) { return !is_deleted(CellHandle(i)); });
  renumber_attached(map, n_vertices, n_cells);
  const std::size_t vertex_gap = first_gap(map.vertices, n_vertices);
  close_gaps(map.vertices, vertex_gap, n_vertices, labels_.vertices);
  close_gaps(map.vertices, vertex_gap, n_vertices, points_);
  close_gaps(map.vertices, vertex_gap, n_vertices, vertex_status_);
  par::for_each(options.policy, cells_.size(), [&](std::size_t i) {
    if (map.cells[i].is_valid()) cells_[i] = renamed(cells_[i], map);
  });
  const std::size_t cell_gap = first_gap(map.cells, n_cells);
  close_gaps(map.cells, cell_gap, n_cells, regions_);
  close_gaps(map.cells, cell_gap, n_cells, cell_status_);
  close_gaps(map.cells, cell_gap, n_cells, cells_);
  free_cells_.clear();
  n_deleted_vertices_.n = 0;
  find_incident_cells(options.policy);
  return map;
}

}  // namespace hfr
