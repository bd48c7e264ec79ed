// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Cut.hh"

#include <algorithm>
#include <utility>

#include "Distributed/Near.hh"

namespace hfr::mpi {

Cut::Cut(const TetMesh& mesh, const Workspace& work, std::span<const int> owner, int n_ranks,
         par::Policy policy)
    : mesh_(mesh),
      work_(work),
      owner_(owner),
      policy_(policy),
      held_(static_cast<std::size_t>(n_ranks)),
      cell_(mesh.n_cells(), 0),
      vertex_(mesh.n_vertices(), 0),
      marks_(mesh.n_vertices(), 0) {
  find_held(n_ranks);
}

/// Far from all cells that have vertices of two owners, one rank holds a cell: that of any vertex of it.
void Cut::find_held(int n_ranks) {
  const auto cells_where = [&](auto&& has) {
    return par::compact<Index>(policy_, mesh_.n_cells(), [&](std::size_t c) {
      return !mesh_.is_deleted(CellHandle(c)) && has(mesh_.cell(CellHandle(c)).v);
    });
  };
  std::vector<Index> border = cells_where([&](const auto& v) {
    const int first = owner_[v[0].idx()];
    return owner_[v[1].idx()] != first || owner_[v[2].idx()] != first || owner_[v[3].idx()] != first;
  });
  for (int step = 1; step <= 2; ++step) {  // marks: vertices within `step` edges of another owner's
    for (Index c : border)
      for (VertexHandle v : mesh_.cell(CellHandle(c)).v) marks_[v.idx()] = 1;
    border = cells_where([&](const auto& v) {
      return (marks_[v[0].idx()] | marks_[v[1].idx()] | marks_[v[2].idx()] | marks_[v[3].idx()]) != 0;
    });
  }
  RankSets one(mesh_.n_vertices(), n_ranks), two(mesh_.n_vertices(), n_ranks);
  find_near(
      mesh_, border, [&](VertexHandle v) { return owner_[v.idx()]; }, one, two);
  RankSet set(two.words());
  std::size_t next = 0;  // of the border
  for (auto& held : held_) held.reserve(mesh_.n_cells() / held_.size() + border.size());
  for (std::size_t c = 0; c < mesh_.n_cells(); ++c) {
    if (mesh_.is_deleted(CellHandle(c))) continue;
    const auto& v = mesh_.cell(CellHandle(c)).v;
    if (next == border.size() || border[next] != c) {
      held_[static_cast<std::size_t>(owner_[v[0].idx()])].push_back(static_cast<Index>(c));
      continue;
    }
    ++next;
    set.clear();
    for (VertexHandle u : v) set.add(two[u.idx()]);
    for_ranks(set.bits(),
              [&](int r) { held_[static_cast<std::size_t>(r)].push_back(static_cast<Index>(c)); });
  }
}

Block Cut::message(int rank) {
  const std::vector<Index> cells = std::exchange(held_[static_cast<std::size_t>(rank)], {});
  par::for_each(policy_, cells.size(), [&](std::size_t i) { cell_[cells[i]] = static_cast<Index>(i); });
  const std::vector<Index> vertices = vertices_of(cells, rank);
  PartHeader header;
  header.n_slots = mesh_.n_cells();
  header.n_free = mesh_.free_cells().size();
  header.n_vertices = vertices.size();
  header.n_vertices_of_whole = mesh_.n_vertices();
  header.n_cells = cells.size();
  header.floor = work_.floor;
  header.clock = work_.clock;
  header.holds_damage = work_.holds_damage ? 1 : 0;
  header.has_regions = mesh_.has_regions() ? 1 : 0;
  Block block = PartArrays::block_for(header);
  const PartArrays arrays = PartArrays::in(block);
  for (std::size_t i = 0; i < arrays.free.size(); ++i) arrays.free[i] = mesh_.free_cells()[i].idx();
  write_vertices(vertices, cells, arrays);
  write_cells(cells, arrays);
  return block;
}

/// Ascending; notes their places. Also those right behind the cells: they may come near, and to make room for
/// a vertex later takes O(part).
std::vector<Index> Cut::vertices_of(std::span<const Index> cells, int rank) {
  std::fill(marks_.begin(), marks_.end(), std::uint8_t{0});
  for (Index c : cells) {
    const Cell& cell = mesh_.cell(CellHandle(c));
    bool is_own = true;
    for (VertexHandle v : cell.v) {
      marks_[v.idx()] = 1;
      is_own = is_own && owner_[v.idx()] == rank;
    }
    if (is_own) continue;
    for (HalfFaceHandle m : cell.mate)
      if (m.is_valid() && place_of(cell_of(m).idx(), cells) == PartArrays::kNothing)
        marks_[mesh_.halfface_opposite_vertex(m).idx()] = 1;
  }
  std::vector<Index> vertices =
      par::compact<Index>(policy_, marks_.size(), [&](std::size_t v) { return marks_[v] != 0; });
  par::for_each(policy_, vertices.size(),
                [&](std::size_t i) { vertex_[vertices[i]] = static_cast<Index>(i); });
  return vertices;
}

void Cut::write_vertices(std::span<const Index> vertices, std::span<const Index> cells,
                         const PartArrays& out) const {
  par::for_each(policy_, vertices.size(), [&](std::size_t i) {
    const Index v = vertices[i];
    out.vertex_number[i] = v;
    out.point[i] = mesh_.points()[v];
    out.owner[i] = owner_[v];
    out.star_size[i] = work_.star_size[v];
    out.changed[i] = work_.changed[v];
    out.frozen[i] = work_.frozen[v];
    const CellHandle c = mesh_.incident_cell(VertexHandle(v));
    out.incident[i] = c.is_valid() ? place_of(c.idx(), cells) : PartArrays::kNothing;
  });
}

void Cut::write_cells(std::span<const Index> cells, const PartArrays& out) const {
  const bool has_regions = mesh_.has_regions();
  par::for_each(policy_, cells.size(), [&](std::size_t i) {
    const CellHandle c(cells[i]);
    const Cell& cell = mesh_.cell(c);
    out.cell_number[i] = c.idx();
    for (std::size_t k = 0; k < 4; ++k) {
      out.corners[i][k] = vertex_[cell.v[k].idx()];
      const HalfFaceHandle m = cell.mate[k];
      const Index there = m.is_valid() ? place_of(cell_of(m).idx(), cells) : PartArrays::kNothing;
      out.mates[i][k] = there == PartArrays::kNothing ? there : 4 * there + static_cast<Index>(corner_of(m));
    }
    out.quality[i] = work_.quality[c.idx()];
    out.pending[i] = work_.pending[c.idx()];
    if (has_regions) out.region[i] = mesh_.region(c);
  });
}

}  // namespace hfr::mpi
