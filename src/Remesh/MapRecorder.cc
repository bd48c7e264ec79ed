// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/MapRecorder.hh"

#include "HalfFace/TupleMap.hh"

namespace hfr {
namespace {

constexpr const char* kSource = "hfr: source of the vertex";

/// Where h goes; an empty list: it stays. Handles beyond the list are newer than it.
template <class H>
H gone_to(const std::vector<H>& to, H h) {
  if (!h.is_valid() || to.empty()) return h;
  return h.idx() < to.size() ? to[h.idx()] : H();
}

}  // namespace

MapRecorder::MapRecorder(TetMesh& mesh)
    : mesh_(mesh),
      n_vertices_(mesh.n_vertices()),
      cells_(mesh.n_cells()),
      source_(mesh.request_vertex_property<Index>(kSource, VertexHandle::kInvalid)) {
  for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i] = mesh.cell(CellHandle(i)).v;
  for (std::size_t i = 0; i < n_vertices_; ++i) source_[VertexHandle(i)] = VertexHandle(i).idx();
}

MapRecorder::~MapRecorder() { mesh_.properties().vertices.remove(kSource); }

MeshMaps MapRecorder::maps(const GarbageMap& order, const GarbageMap& garbage) {
  MeshMaps maps;
  maps.vertices.resize(n_vertices_);
  maps.cells.resize(cells_.size());
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
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const CellHandle c = gone_to(garbage.cells, gone_to(order.cells, CellHandle(i)));
    if (!c.is_valid() || c.idx() >= mesh_.n_cells() || mesh_.is_deleted(c)) continue;
    std::array<VertexHandle, 4> vertices = cells_[i];
    bool all = true;
    for (VertexHandle& v : vertices) {
      v = v.is_valid() ? maps.vertices[v.idx()] : v;
      all = all && v.is_valid();
    }
    // A slot may have been filled with another cell, or with the same again.
    if (!all || AnyOrder::key(vertices) != AnyOrder::key(mesh_.cell(c).v)) continue;
    maps.cells[i] = c;
    maps.old_cells[c.idx()] = CellHandle(i);
  }
  return maps;
}

}  // namespace hfr
