// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/MapRecorder.hh"

#include <algorithm>
#include <type_traits>

#include "HalfFace/TupleMap.hh"

namespace hfr {
namespace {

constexpr const char* kSource = "hfr: source of the vertex";
constexpr const char* kOrigin = "hfr: origin of the cell";

/// Where h goes; an empty list: it stays. Handles beyond the list are newer than it.
template <class H>
H gone_to(const std::vector<H>& to, H h) {
  if (!h.is_valid() || to.empty()) return h;
  return h.idx() < to.size() ? to[h.idx()] : H();
}

}  // namespace

MapRecorder::MapRecorder(TetMesh& mesh, const TetMesh* before)
    : mesh_(mesh),
      before_(before),
      n_vertices_(mesh.n_vertices()),
      n_cells_(mesh.n_cells()),
      cells_(before ? 0 : mesh.n_cells()),
      source_(mesh.request_vertex_property<Index>(kSource, VertexHandle::kInvalid)) {
  for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i] = mesh.cell(CellHandle(i)).v;
  for (std::size_t i = 0; i < n_vertices_; ++i) source_[VertexHandle(i)] = VertexHandle(i).idx();
  if (mesh.properties().cells.empty()) return;
  origin_ = mesh.request_cell_property<Index>(kOrigin, CellHandle::kInvalid);
  for (std::size_t i = 0; i < n_cells_; ++i) (*origin_)[CellHandle(i)] = CellHandle(i).idx();
}

MapRecorder::~MapRecorder() {
  mesh_.properties().vertices.remove(kSource);
  if (origin_) mesh_.properties().cells.remove(kOrigin);
}

/// What the cell had before the run.
void MapRecorder::restore(CellHandle old, CellHandle now) {
  for (const auto& property : mesh_.properties().cells)
    for (const auto& before : before_->properties().cells)
      if (before->name() == property->name() && before->type() == property->type())
        property->copy_from(*before, old.idx(), now.idx());
  if (const bool was = before_->is_selected(old); mesh_.is_selected(now) != was) mesh_.set_selected(now, was);
  if (const bool was = before_->is_tagged(old); mesh_.is_tagged(now) != was) mesh_.set_tagged(now, was);
}

MeshMaps MapRecorder::maps(const GarbageMap& order, const GarbageMap& garbage, par::Policy policy) {
  const auto& list = mesh_.properties().cells;
  const bool can_restore = before_ && std::none_of(list.begin(), list.end(), [](const auto& property) {
                             return property->is_anonymous();  // by which name is it there?
                           });
  MeshMaps maps;
  maps.vertices.resize(n_vertices_);
  maps.cells.resize(n_cells_);
  maps.old_vertices.resize(mesh_.n_vertices());
  maps.old_cells.resize(mesh_.n_cells());
  maps.sources.resize(mesh_.n_vertices());
  for (std::size_t i = 0; i < n_vertices_; ++i) {
    const VertexHandle v = gone_to(garbage.vertices, gone_to(order.vertices, VertexHandle(i)));
    if (!v.is_valid() || mesh_.is_deleted(v)) continue;
    maps.vertices[i] = v;
    maps.old_vertices[v.idx()] = VertexHandle(i);
  }
  for (std::size_t i = 0; i < maps.sources.size(); ++i)
    if (!mesh_.is_deleted(VertexHandle(i))) maps.sources[i] = VertexHandle(source_[VertexHandle(i)]);
  par::for_each(policy, n_cells_, [&](std::size_t i) {
    const CellHandle c = gone_to(garbage.cells, gone_to(order.cells, CellHandle(i)));
    if (!c.is_valid() || c.idx() >= mesh_.n_cells() || mesh_.is_deleted(c)) return;
    std::array<VertexHandle, 4> vertices = old_cell(i);
    for (VertexHandle& v : vertices) {
      v = v.is_valid() ? maps.vertices[v.idx()] : v;
      if (!v.is_valid()) return;
    }
    // A slot may have been filled with another cell, or with the same again.
    const auto& now = mesh_.cell(c).v;
    if (vertices != now && AnyOrder::key(vertices) != AnyOrder::key(now)) return;
    if (origin_ && (*origin_)[c] != CellHandle(i).idx()) {
      if (!can_restore) return;
      restore(CellHandle(i), c);
    }
    maps.cells[i] = c;
    maps.old_cells[c.idx()] = CellHandle(i);
  });
  return maps;
}

MeshMaps with_old_handles(const GarbageMap& garbage, const MeshMaps& maps) {
  const auto of_old = [](const auto& to, const auto& new_of) {
    std::remove_cvref_t<decltype(new_of)> result(to.size());
    for (std::size_t i = 0; i < to.size(); ++i)
      if (to[i].is_valid()) result[i] = new_of[to[i].idx()];
    return result;
  };
  const auto to_old = [](const auto& to, auto list, std::size_t n) {
    std::remove_cvref_t<decltype(to)> from(n);
    for (std::size_t i = 0; i < to.size(); ++i)
      if (to[i].is_valid()) from[to[i].idx()] = typename std::remove_cvref_t<decltype(to)>::value_type(i);
    for (auto& h : list)
      if (h.is_valid()) h = from[h.idx()];
    return list;
  };
  return {.vertices = of_old(garbage.vertices, maps.vertices),
          .cells = of_old(garbage.cells, maps.cells),
          .old_vertices = to_old(garbage.vertices, maps.old_vertices, maps.vertices.size()),
          .old_cells = to_old(garbage.cells, maps.old_cells, maps.cells.size()),
          .sources = to_old(garbage.vertices, maps.sources, maps.vertices.size())};
}

}  // namespace hfr
