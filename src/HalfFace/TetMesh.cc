// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/TetMesh.hh"

#include <algorithm>
#include <string>

#include "HalfFace/Errors.hh"

namespace hfr {
namespace {

constexpr unsigned kSmallStar = 64;   // cells; most stars have fewer, and a smaller table is sooner cleared
constexpr unsigned kSmallMask = 255;  // their table has few collisions
constexpr unsigned kMask = 2 * Star::kCapacity - 1;

unsigned place_of(CellHandle c, unsigned mask) {
  return (static_cast<std::uint32_t>(c.idx()) * 0x9e3779b1U >> 16) & mask;
}

/// 1 when c was entered into the first mask + 1 slots, 0 when it was there. Without a branch that depends on
/// the answer, which nobody can foretell.
unsigned enter(Star& star, unsigned mask, CellHandle c) {
  unsigned at = place_of(c, mask);
  while (star.slot[at].is_valid() && star.slot[at] != c) at = (at + 1) & mask;
  const unsigned is_new = star.slot[at].is_valid() ? 0 : 1;
  star.slot[at] = c;
  return is_new;
}

/// Clears the first mask + 1 slots and enters the first `size` cells.
void enter_all(Star& star, unsigned mask, unsigned size) {
  std::fill_n(star.slot.begin(), mask + 1, CellHandle());
  for (unsigned i = 0; i < size; ++i) enter(star, mask, star.cells[i]);
}

}  // namespace

void TetMesh::set_region(CellHandle c, int region) {
  if (regions_.empty()) {
    if (region == 0) return;
    regions_.assign(cells_.size(), 0);
  }
  regions_[c.idx()] = region;
}

void TetMesh::set_fixed(EdgeHandle e, bool fixed) {
  if (fixed)
    locks_.edges.set(edge_vertices(e), true);
  else
    locks_.edges.erase_unordered(edge_vertices(e));
}

void TetMesh::set_fixed(FaceHandle f, bool fixed) {
  if (fixed)
    locks_.faces.set(face_vertices(f), true);
  else
    locks_.faces.erase_unordered(face_vertices(f));
}

void TetMesh::set_fixed_patch(int label, bool fixed) {
  if (fixed)
    locks_.patches.insert(label);
  else
    locks_.patches.erase(label);
}

void TetMesh::restore(TetMesh saved) {
  PropertySet mine = std::move(properties_);
  mine.take(saved.properties_, saved.n_vertices(), saved.n_cells());
  *this = std::move(saved);
  properties_ = std::move(mine);
  hand_index_state_ = kVoid;
}

VertexHandle TetMesh::add_vertex(Vec3 p) {
  const VertexHandle v(points_.size());
  points_.push_back(p);
  incident_cell_.push_back(CellHandle());
  vertex_status_.push_back(0);
  if (!labels_.vertices.empty()) labels_.vertices.push_back(0);
  properties_.resize_vertices(points_.size());
  return v;
}

void TetMesh::resize_cells(std::size_t n) {
  if (n > kMostCells)
    throw ResourceLimit("a mesh of " + std::to_string(n) +
                        " cells is too large for the indices of this build");
  hand_index_state_ = kVoid;
  grow_cells(n);
}

void TetMesh::grow_cells(std::size_t n) {
  // A doubled vector of cells would cost more memory, and time to copy it, than all of a small repair.
  if (n > cells_.capacity()) cells_.reserve(n + n / kHeadroom + kHeadroom);
  cells_.resize(n);
  if (!regions_.empty()) regions_.resize(n, 0);
  if (!cell_status_.empty()) cell_status_.resize(n, 0);
  properties_.resize_cells(n);
}

void TetMesh::mark_deleted(VertexHandle v) {
  if (is_deleted(v)) return;
  vertex_status_[v.idx()] |= kDeleted;
  incident_cell_[v.idx()].reset();
  ++n_deleted_vertices_.n;
}

bool TetMesh::gather_star(VertexHandle v, Star& star) const {
  star.size = 0;
  const CellHandle first = incident_cell(v);
  if (!first.is_valid()) return false;
  star.cells[0] = first;
  unsigned size = 1;
  unsigned mask = kSmallMask;
  enter_all(star, mask, size);
  for (unsigned i = 0; i < size; ++i) {
    const Cell& k = cell(star.cells[i]);
    const std::uint8_t corner = k.own_corner(v);
    star.corners[i] = corner;
    for (unsigned turn = 1; turn < 4; ++turn) {
      const HalfFaceHandle m = k.mate[(corner + turn) & 3];
      if (!m.is_valid()) continue;
      const CellHandle c = cell_of(m);
      __builtin_prefetch(&cells_[c.idx()]);  // its turn comes in a few rounds
      star.cells[size] = c;                  // kept if it is new
      size += enter(star, mask, c);
      if (size > Star::kCapacity) return false;
    }
    if (size > kSmallStar && mask == kSmallMask) enter_all(star, mask = kMask, size);
  }
  star.size = static_cast<int>(size);
  return true;
}

bool TetMesh::has_edge(VertexHandle a, VertexHandle b, Star& scratch) const {
  if (!gather_star(a, scratch))
    return incident_cell(a).is_valid();  // too large to tell: say yes, which only refuses
  for (int i = 0; i < scratch.size; ++i)
    if (cell(scratch.cells[static_cast<std::size_t>(i)]).has(b)) return true;
  return false;
}

bool TetMesh::has_face(VertexHandle a, VertexHandle b, VertexHandle c, Star& scratch) const {
  if (!gather_star(a, scratch)) return incident_cell(a).is_valid();
  for (int i = 0; i < scratch.size; ++i) {
    const Cell& k = cell(scratch.cells[static_cast<std::size_t>(i)]);
    if (k.has(b) && k.has(c)) return true;
  }
  return false;
}

}  // namespace hfr
