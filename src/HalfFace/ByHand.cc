// SPDX-License-Identifier: BSD-3-Clause
// Building and taking apart one cell at a time. A new cell finds its neighbours through a table of all faces,
// which is made when first needed and kept up to date here; whatever else writes to the mesh voids it. A cell
// that goes knows its neighbours. Only where they cannot tell whether a vertex or an edge has other cells is
// the number of cells of each vertex asked for, which is counted when first needed.
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

void TetMesh::count_cells() {
  if (hand_index_state_ != kVoid) {
    hand_index_.n_cells.resize(points_.size(), 0);
    return;
  }
  hand_index_.n_cells.assign(points_.size(), 0);
  for (const Cell& k : cells_)
    if (k.v[0].is_valid())
      for (VertexHandle v : k.v) ++hand_index_.n_cells[v.idx()];
  hand_index_state_ = kCounts;
}

void TetMesh::make_hand_index() {
  count_cells();
  if (hand_index_state_ == kCountsAndFaces) return;
  hand_index_.face.clear();
  for (HalfFaceHandle h : halffaces()) hand_index_.face.emplace(AnyOrder::key(halfface_vertices(h)), h);
  hand_index_state_ = kCountsAndFaces;
}

bool TetMesh::gather_whole_star(VertexHandle v, Star& star) {
  count_cells();
  return gather_star(v, star) && static_cast<Index>(star.size) == hand_index_.n_cells[v.idx()];
}

std::vector<CellHandle> TetMesh::cells_of(VertexHandle v) {
  Star star;
  if (gather_whole_star(v, star)) return {star.cells.begin(), star.cells.begin() + star.size};
  std::vector<CellHandle> found;
  for (std::size_t i = 0; hand_index_.n_cells[v.idx()] > 0 && i < cells_.size(); ++i)
    if (cells_[i].has(v)) found.push_back(CellHandle(i));
  return found;
}

template <std::size_t N>
bool TetMesh::any_cell_has(const std::array<VertexHandle, N>& vertices) {
  for (CellHandle c : cells_of(vertices[0])) {
    const Cell& k = cell(c);
    if (std::all_of(vertices.begin(), vertices.end(), [&](VertexHandle v) { return k.has(v); })) return true;
  }
  return false;
}

CellHandle TetMesh::add_cell(VertexHandle v0, VertexHandle v1, VertexHandle v2, VertexHandle v3) {
  const Cell created{{v0, v1, v2, v3}, {}};
  for (VertexHandle v : created.v)
    HFR_REQUIRE(exists(v), "add_cell: vertex" + numbers({&v, 1}) + " does not exist");
  const auto sorted = AnyOrder::key(created.v);
  HFR_REQUIRE(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(),
              "add_cell: of the vertices" + numbers(created.v) + " two are the same");
  make_hand_index();
  std::array<HalfFaceHandle, 4> mates;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& f = kFaceCorners[k];
    const std::array<VertexHandle, 3> face = {created.v[f[0]], created.v[f[1]], created.v[f[2]]};
    const auto found = hand_index_.face.find(AnyOrder::key(face));
    if (found == hand_index_.face.end()) continue;
    const HalfFaceHandle m = found->second;
    HFR_REQUIRE(!opposite_halfface(m).is_valid(), "add_cell: the face of vertices" + numbers(face) +
                                                      " has two cells already, one of them cell " +
                                                      std::to_string(cell_of(m).idx()));
    HFR_REQUIRE(halfface_opposite_vertex(m) != created.v[k],
                "add_cell: cell " + std::to_string(cell_of(m).idx()) + " has the same four vertices" +
                    numbers(created.v));
    HFR_REQUIRE(CyclicOrder::key(halfface_vertices(m)) != CyclicOrder::key(face),
                "add_cell: vertices" + numbers(created.v) +
                    " lie the wrong way round for their neighbour, cell " + std::to_string(cell_of(m).idx()) +
                    "; exchange two of them");
    mates[k] = m;
  }
  const CellHandle c(cells_.size());
  if (c.idx() >= kMostCells) throw ResourceLimit("add_cell: no index is left for another cell");
  grow_cells(cells_.size() + 1);
  cells_[c.idx()] = created;
  for (std::size_t k = 0; k < 4; ++k) {
    const HalfFaceHandle h = halfface_of(c, static_cast<int>(k));
    if (!mates[k].is_valid()) {
      hand_index_.face.emplace(AnyOrder::key(halfface_vertices(h)), h);
      continue;
    }
    cells_[c.idx()].mate[k] = mates[k];
    cells_[mates[k].idx() / 4].mate[mates[k].idx() % 4] = h;
  }
  for (VertexHandle v : created.v) {
    ++hand_index_.n_cells[v.idx()];
    if (!incident_cell_[v.idx()].is_valid()) incident_cell_[v.idx()] = c;
  }
  return c;
}

void TetMesh::delete_cell(CellHandle c) {
  HFR_REQUIRE(exists(c), "delete_cell: cell " + std::to_string(c.idx()) + " does not exist");
  if (hand_index_state_ != kVoid) count_cells();
  const Cell removed = cell(c);
  for (std::size_t k = 0; k < 4; ++k) {
    const HalfFaceHandle m = removed.mate[k];
    if (m.is_valid()) cells_[m.idx() / 4].mate[m.idx() % 4] = HalfFaceHandle();
    if (hand_index_state_ != kCountsAndFaces) continue;
    const auto key = AnyOrder::key(halfface_vertices(halfface_of(c, static_cast<int>(k))));
    if (m.is_valid())
      hand_index_.face[key] = m;
    else
      hand_index_.face.erase(key);
  }
  cells_[c.idx()] = Cell{};
  free_cells_.push_back(c);
  if (hand_index_state_ != kVoid)
    for (VertexHandle v : removed.v) --hand_index_.n_cells[v.idx()];
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const VertexHandle v = removed.v[corner];
    if (incident_cell_[v.idx()] != c) continue;
    CellHandle next;
    for (std::size_t k = 0; k < 4; ++k)
      if (k != corner && removed.mate[k].is_valid()) next = std::min(next, cell_of(removed.mate[k]));
    incident_cell_[v.idx()] = next;
    if (next.is_valid()) continue;
    // The cells that are left may touch in v alone: then a pass over all cells finds one.
    count_cells();
    if (hand_index_.n_cells[v.idx()] == 0) continue;
    const auto other = std::find_if(cells_.begin(), cells_.end(), [&](const Cell& k) { return k.has(v); });
    incident_cell_[v.idx()] = CellHandle(other - cells_.begin());
  }
  drop_labels_of_nothing(removed);
}

/// A face goes with its last cell; so does an edge, but others may have it that no face of `removed` leads
/// to.
void TetMesh::drop_labels_of_nothing(const Cell& removed) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (labels_.faces.empty() && locks_.faces.empty()) break;
    if (removed.mate[k].is_valid()) continue;
    const auto& f = kFaceCorners[k];
    const std::array<VertexHandle, 3> face = {removed.v[f[0]], removed.v[f[1]], removed.v[f[2]]};
    labels_.faces.erase(face);
    locks_.faces.erase(face);
  }
  for (std::size_t k = 0; k < 6; ++k) {
    if (labels_.edges.empty() && locks_.edges.empty()) break;
    if (removed.mate[kEdgeOpposite[k][0]].is_valid() || removed.mate[kEdgeOpposite[k][1]].is_valid())
      continue;
    const std::array<VertexHandle, 2> edge = {removed.v[kEdgeCorners[k][0]], removed.v[kEdgeCorners[k][1]]};
    if (!labels_.edges.find(edge) && !locks_.edges.find(edge)) continue;
    if (any_cell_has(edge)) continue;
    labels_.edges.erase(edge);
    locks_.edges.erase(edge);
  }
}

void TetMesh::delete_vertex(VertexHandle v) {
  HFR_REQUIRE(exists(v), "delete_vertex: vertex " + std::to_string(v.idx()) + " does not exist");
  while (incident_cell(v).is_valid()) delete_cell(incident_cell(v));
  mark_deleted(v);
}

void TetMesh::reserve_vertices(std::size_t n) {
  points_.reserve(n);
  incident_cell_.reserve(n);
  vertex_status_.reserve(n);
}

void TetMesh::reserve_cells(std::size_t n) { cells_.reserve(n); }

void TetMesh::swap_cells(CellHandle a, CellHandle b) {
  for (CellHandle c : {a, b})
    HFR_REQUIRE(exists(c), "swap_cells: cell " + std::to_string(c.idx()) + " does not exist");
  if (a == b) return;
  const auto now = [&](CellHandle c) { return c == a ? b : c == b ? a : c; };
  std::array<VertexHandle, 8> corners;
  std::copy_n(cell(a).v.begin(), 4, corners.begin());
  std::copy_n(cell(b).v.begin(), 4, corners.begin() + 4);
  std::sort(corners.begin(), corners.end());
  const auto end = std::unique(corners.begin(), corners.end());
  for (auto v = corners.begin(); v != end; ++v) incident_cell_[v->idx()] = now(incident_cell_[v->idx()]);
  std::swap(cells_[a.idx()], cells_[b.idx()]);
  for (CellHandle c : {a, b})
    for (HalfFaceHandle& m : cells_[c.idx()].mate)
      if (m.is_valid()) m = halfface_of(now(cell_of(m)), corner_of(m));
  for (CellHandle c : {a, b}) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle m = opposite_halfface(halfface_of(c, k));
      if (m.is_valid()) cells_[m.idx() / 4].mate[m.idx() % 4] = halfface_of(c, k);
    }
  }
  if (!regions_.empty()) std::swap(regions_[a.idx()], regions_[b.idx()]);
  if (!cell_status_.empty()) std::swap(cell_status_[a.idx()], cell_status_[b.idx()]);
  properties_.swap_cells(a, b);
  outdate_hand_faces();
}

void TetMesh::swap_vertices(VertexHandle a, VertexHandle b) {
  for (VertexHandle v : {a, b})
    HFR_REQUIRE(exists(v), "swap_vertices: vertex " + std::to_string(v.idx()) + " does not exist");
  if (a == b) return;
  const auto now = [&](VertexHandle v) { return v == a ? b : v == b ? a : v; };
  std::vector<CellHandle> all = cells_of(a);
  for (CellHandle c : cells_of(b))
    if (!cell(c).has(a)) all.push_back(c);
  for (CellHandle c : all)
    for (VertexHandle& v : cells_[c.idx()].v) v = now(v);
  std::swap(points_[a.idx()], points_[b.idx()]);
  std::swap(incident_cell_[a.idx()], incident_cell_[b.idx()]);
  std::swap(vertex_status_[a.idx()], vertex_status_[b.idx()]);
  std::swap(hand_index_.n_cells[a.idx()], hand_index_.n_cells[b.idx()]);
  if (!labels_.vertices.empty()) std::swap(labels_.vertices[a.idx()], labels_.vertices[b.idx()]);
  const auto rename = [&](auto& map) { map.rename_vertices(now, [](const auto&) { return true; }); };
  rename(labels_.faces);
  rename(labels_.edges);
  rename(locks_.faces);
  rename(locks_.edges);
  properties_.swap_vertices(a, b);
  outdate_hand_faces();
}

}  // namespace hfr
