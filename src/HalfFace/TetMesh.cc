// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/TetMesh.hh"

namespace hfr {

void TetMesh::set_region(CellHandle c, int region) {
  if (regions_.empty()) {
    if (region == 0) return;
    regions_.assign(cells_.size(), 0);
  }
  regions_[c.idx()] = region;
}

VertexHandle TetMesh::add_vertex(Vec3 p) {
  const VertexHandle v(points_.size());
  points_.push_back(p);
  hook_.push_back(CellHandle());
  vertex_status_.push_back(0);
  if (!labels_.vertices.empty()) labels_.vertices.push_back(0);
  properties_.resize_vertices(points_.size());
  return v;
}

void TetMesh::resize_cells(std::size_t n) {
  outdate_hand_index();
  grow_cells(n);
}

void TetMesh::grow_cells(std::size_t n) {
  cells_.resize(n);
  if (!regions_.empty()) regions_.resize(n, 0);
  if (!cell_status_.empty()) cell_status_.resize(n, 0);
  properties_.resize_cells(n);
}

void TetMesh::mark_deleted(VertexHandle v) {
  if (is_deleted(v)) return;
  vertex_status_[v.idx()] |= kDeleted;
  hook_[v.idx()].reset();
  ++n_deleted_vertices_;
}

bool TetMesh::gather_star(VertexHandle v, Star& star) const {
  star.size = 0;
  const CellHandle first = hook(v);
  if (!first.is_valid()) return false;
  constexpr unsigned kMask = 2 * Star::kCapacity - 1;
  star.slot.fill(0);
  const auto insert = [&](CellHandle c) {  // false only when the table is full
    unsigned at = (static_cast<std::uint32_t>(c.idx()) * 0x9e3779b1U >> 16) & kMask;
    for (; star.slot[at] != 0; at = (at + 1) & kMask)
      if (star.cells[star.slot[at] - 1U] == c) return true;
    if (star.size == Star::kCapacity) return false;
    star.corners[static_cast<std::size_t>(star.size)] = static_cast<std::uint8_t>(cell(c).corner(v));
    star.cells[static_cast<std::size_t>(star.size)] = c;
    star.slot[at] = static_cast<std::uint16_t>(++star.size);
    return true;
  };
  insert(first);
  for (int i = 0; i < star.size; ++i) {
    const Cell& k = cell(star.cells[static_cast<std::size_t>(i)]);
    const int corner = star.corners[static_cast<std::size_t>(i)];
    for (int f = 0; f < 4; ++f) {
      const HalfFaceHandle m = k.mate[static_cast<std::size_t>(f)];
      if (f == corner || !m.is_valid()) continue;
      if (!insert(cell_of(m))) {
        star.size = 0;
        return false;
      }
    }
  }
  return true;
}

bool TetMesh::has_edge(VertexHandle a, VertexHandle b, Star& scratch) const {
  if (!gather_star(a, scratch)) return hook(a).is_valid();  // too large to tell: say yes, which only refuses
  for (int i = 0; i < scratch.size; ++i)
    if (cell(scratch.cells[static_cast<std::size_t>(i)]).has(b)) return true;
  return false;
}

bool TetMesh::has_face(VertexHandle a, VertexHandle b, VertexHandle c, Star& scratch) const {
  if (!gather_star(a, scratch)) return hook(a).is_valid();
  for (int i = 0; i < scratch.size; ++i) {
    const Cell& k = cell(scratch.cells[static_cast<std::size_t>(i)]);
    if (k.has(b) && k.has(c)) return true;
  }
  return false;
}

}  // namespace hfr
