// SPDX-License-Identifier: BSD-3-Clause
// Building and taking apart one cell at a time. Neighbours are found through a table of all faces, which is
// made when first needed and kept up to date here; whatever else writes to the mesh voids it.
#include <algorithm>

#include "HalfFace/TetMesh.hh"

namespace hfr {
namespace {

std::string numbers(std::span<const VertexHandle> vertices) {
  std::string all;
  for (VertexHandle v : vertices) all += " " + std::to_string(v.idx());
  return all;
}

}  // namespace

void TetMesh::make_hand_index() {
  if (hand_index_valid_) {
    hand_index_.n_cells.resize(points_.size(), 0);
    return;
  }
  hand_index_.face.clear();
  hand_index_.n_cells.assign(points_.size(), 0);
  for (CellHandle c : cells())
    for (VertexHandle v : cell(c).v) ++hand_index_.n_cells[v.idx()];
  for (HalfFaceHandle h : halffaces()) hand_index_.face.emplace(AnyOrder::key(halfface_vertices(h)), h);
  hand_index_valid_ = true;
}

CellHandle TetMesh::add_cell(VertexHandle v0, VertexHandle v1, VertexHandle v2, VertexHandle v3) {
  const Cell born{{v0, v1, v2, v3}, {}};
  for (VertexHandle v : born.v)
    HFR_REQUIRE(exists(v), "add_cell: vertex" + numbers({&v, 1}) + " does not exist");
  const auto sorted = AnyOrder::key(born.v);
  HFR_REQUIRE(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(),
              "add_cell: of the vertices" + numbers(born.v) + " two are the same");
  make_hand_index();
  std::array<HalfFaceHandle, 4> mates;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& f = kFaceCorners[k];
    const std::array<VertexHandle, 3> face = {born.v[f[0]], born.v[f[1]], born.v[f[2]]};
    const auto found = hand_index_.face.find(AnyOrder::key(face));
    if (found == hand_index_.face.end()) continue;
    const HalfFaceHandle m = found->second;
    HFR_REQUIRE(!opposite_halfface(m).is_valid(), "add_cell: the face of vertices" + numbers(face) +
                                                      " has two cells already, one of them cell " +
                                                      std::to_string(cell_of(m).idx()));
    HFR_REQUIRE(CyclicOrder::key(halfface_vertices(m)) != CyclicOrder::key(face),
                "add_cell: vertices" + numbers(born.v) +
                    " lie the wrong way round for their neighbour, cell " + std::to_string(cell_of(m).idx()) +
                    "; exchange two of them");
    mates[k] = m;
  }
  const CellHandle c(cells_.size());
  if (c.idx() >= HalfFaceHandle::kInvalid / 12)
    throw ResourceLimit("add_cell: no index is left for another cell");
  grow_cells(cells_.size() + 1);
  cells_[c.idx()] = born;
  for (std::size_t k = 0; k < 4; ++k) {
    const HalfFaceHandle h = halfface_of(c, static_cast<int>(k));
    if (!mates[k].is_valid()) {
      hand_index_.face.emplace(AnyOrder::key(halfface_vertices(h)), h);
      continue;
    }
    cells_[c.idx()].mate[k] = mates[k];
    cells_[mates[k].idx() / 4].mate[mates[k].idx() % 4] = h;
  }
  for (VertexHandle v : born.v) {
    ++hand_index_.n_cells[v.idx()];
    if (!hook_[v.idx()].is_valid()) hook_[v.idx()] = c;
  }
  return c;
}

void TetMesh::delete_cell(CellHandle c) {
  HFR_REQUIRE(exists(c), "delete_cell: cell " + std::to_string(c.idx()) + " does not exist");
  make_hand_index();
  const Cell dead = cell(c);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto key = AnyOrder::key(halfface_vertices(halfface_of(c, static_cast<int>(k))));
    const HalfFaceHandle m = dead.mate[k];
    if (m.is_valid()) {
      cells_[m.idx() / 4].mate[m.idx() % 4] = HalfFaceHandle();
      hand_index_.face[key] = m;
    } else {
      hand_index_.face.erase(key);
    }
  }
  cells_[c.idx()] = Cell{};
  free_cells_.push_back(c);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const VertexHandle v = dead.v[corner];
    const Index left = --hand_index_.n_cells[v.idx()];
    if (hook_[v.idx()] != c) continue;
    CellHandle next;
    for (std::size_t k = 0; k < 4; ++k)
      if (k != corner && dead.mate[k].is_valid()) next = std::min(next, cell_of(dead.mate[k]));
    // The cells that are left may touch in v alone: then a pass over all cells finds one.
    for (std::size_t i = 0; left > 0 && !next.is_valid() && i < cells_.size(); ++i)
      if (cells_[i].has(v)) next = CellHandle(i);
    hook_[v.idx()] = next;
  }
  drop_labels_of_nothing(dead);
}

void TetMesh::drop_labels_of_nothing(const Cell& dead) {
  for (const auto& f : kFaceCorners) {
    if (labels_.faces.empty() && locks_.faces.empty()) break;
    const std::array<VertexHandle, 3> face = {dead.v[f[0]], dead.v[f[1]], dead.v[f[2]]};
    if (hand_index_.face.contains(AnyOrder::key(face))) continue;
    labels_.faces.erase(face);
    locks_.faces.erase(face);
  }
  for (const auto& e : kEdgeCorners) {
    if (labels_.edges.empty() && locks_.edges.empty()) break;
    const std::array<VertexHandle, 2> edge = {dead.v[e[0]], dead.v[e[1]]};
    if (!labels_.edges.find(edge) && !locks_.edges.find(edge)) continue;
    const bool lives = std::any_of(cells_.begin(), cells_.end(),
                                   [&](const Cell& k) { return k.has(edge[0]) && k.has(edge[1]); });
    if (lives) continue;
    labels_.edges.erase(edge);
    locks_.edges.erase(edge);
  }
}

void TetMesh::delete_vertex(VertexHandle v) {
  HFR_REQUIRE(exists(v), "delete_vertex: vertex " + std::to_string(v.idx()) + " does not exist");
  while (hook(v).is_valid()) delete_cell(hook(v));
  mark_deleted(v);
}

}  // namespace hfr
