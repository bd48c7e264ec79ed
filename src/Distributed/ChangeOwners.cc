// SPDX-License-Identifier: BSD-3-Clause
// Vertices that come to belong to other ranks.
#include <algorithm>
#include <utility>

#include "Distributed/DistributedMesh.hh"
#include "HalfFace/Writer.hh"

namespace hfr::mpi {

/// Ranks that hold a cell of a vertex are within two edges of a vertex of that cell.
std::vector<std::vector<VertexHandle>> DistributedMesh::held_by_others() const {
  RankSets holders(mesh_.n_vertices(), comm_.size());
  std::vector<std::uint8_t> is_near(mesh_.n_vertices(), 0);
  for (Index i : zone_) {
    if (mesh_.is_deleted(CellHandle(i))) continue;
    const auto& corners = mesh_.cell(CellHandle(i)).v;
    for (VertexHandle v : corners) {
      if (!is_own(v)) continue;
      is_near[v.idx()] = 1;
      for (VertexHandle u : corners) holders.add(v.idx(), near2_[u.idx()]);
    }
  }
  std::vector<std::vector<VertexHandle>> held_by(comm_.n_ranks());
  for (std::size_t v = 0; v < is_near.size(); ++v)
    if (is_near[v] != 0)
      for_ranks(holders[v], [&](int rank) {
        if (rank != comm_.rank()) held_by[static_cast<std::size_t>(rank)].emplace_back(v);
      });
  return held_by;
}

void DistributedMesh::change_owners(std::span<const int> to) {
  const std::vector<int> before = owner_;
  const RankSets held = near2_;
  tell_owners(to);
  start_zone();  // of a part that still is what it was: who is within two edges of what was this rank's own
  const auto records = [&] {
    std::vector<Push> pushes = fresh_near(before, held);
    std::vector<Packer> packed(comm_.n_ranks());
    for (std::size_t r = 0; r < pushes.size(); ++r) {
      auto [cells, vertices] = std::exchange(pushes[r], {});
      if (vertices.empty()) continue;
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
      pack(cells, vertices, packed[r], /*as_owner=*/true);
    }
    Records come;
    for (const Comm::Message& message : comm_.exchange(packed)) {
      Unpacker in(message.bytes);
      come.append(in);
    }
    return come;
  };
  apply(records());
  start_zone();
  prune();
  drop_dead_slots();
}

void DistributedMesh::drop_dead_slots() {
  std::vector<CellHandle> order;
  for (CellHandle c : mesh_.cells()) order.push_back(c);
  if (order.size() == mesh_.n_cells() && n_sorted_ == order.size()) return;
  const auto is_in_order = [&](CellHandle a, CellHandle b) { return number(a) < number(b); };
  if (!std::is_sorted(order.begin(), order.end(), is_in_order))
    std::sort(order.begin(), order.end(), is_in_order);
  std::vector<CellHandle> to(mesh_.n_cells());
  for (std::size_t i = 0; i < order.size(); ++i) to[order[i].idx()] = CellHandle(i);
  const auto in_order = [&]<class T>(std::vector<T>& values) {
    std::vector<T> moved;
    moved.reserve(order.size());
    for (CellHandle c : order) moved.push_back(values[c.idx()]);
    values = std::move(moved);
  };
  TetMesh::Writer writer(mesh_);
  std::vector<Cell> cells;
  std::vector<int> regions;
  cells.reserve(order.size());
  for (CellHandle c : order) {
    Cell& cell = cells.emplace_back(mesh_.cell(c));
    for (HalfFaceHandle& m : cell.mate)
      if (m.is_valid()) m = halfface_of(to[cell_of(m).idx()], corner_of(m));
    if (mesh_.has_regions()) regions.push_back(mesh_.region(c));
  }
  for (std::size_t v = 0; v < mesh_.n_vertices(); ++v) {
    CellHandle& incident = writer.incident_cell(VertexHandle(v));
    if (incident.is_valid()) incident = to[incident.idx()];
  }
  if (!mesh_.properties().cells.empty()) {
    std::vector<Index> places;
    for (CellHandle c : to) places.push_back(c.idx());
    for (const auto& p : mesh_.properties().cells) p->permute(places, order.size());
  }
  writer.resize_cells(order.size());
  for (std::size_t i = 0; i < cells.size(); ++i) writer.cell(CellHandle(i)) = cells[i];
  for (std::size_t i = 0; i < regions.size(); ++i) mesh_.set_region(CellHandle(i), regions[i]);
  in_order(work_.quality);
  in_order(work_.pending);
  work_.claim.assign(order.size(), kUnclaimed);
  work_.all_touched = true;
  in_order(cell_number_);
  n_sorted_ = cell_number_.size();
  later_.clear();
  start_zone();
  complete_rim();
}

/// Those of own vertices, to whoever holds them.
void DistributedMesh::tell_owners(std::span<const int> to) {
  struct Told {
    std::uint64_t number = 0;
    std::int64_t owner = 0;
  };
  std::vector<Packer> packed(comm_.n_ranks());
  const auto held_by = held_by_others();
  for (std::size_t r = 0; r < held_by.size(); ++r)
    for (VertexHandle v : held_by[r])
      if (to[v.idx()] != comm_.rank()) packed[r].put(Told{number(v), to[v.idx()]});
  for (std::size_t i = 0; i < owner_.size(); ++i) {
    const VertexHandle v(i);
    if (is_own(v) && !mesh_.is_deleted(v) && mesh_.incident_cell(v).is_valid()) owner_[i] = to[i];
  }
  for (const Comm::Message& message : comm_.exchange(packed))
    for (Unpacker in(message.bytes); !in.at_end();) {
      const Told told = in.get<Told>();
      if (const VertexHandle v = vertex_at(told.number); v.is_valid())
        owner_[v.idx()] = static_cast<int>(told.owner);
    }
}

/// For each rank: what has come within two edges of its vertices. A cell is sent by the rank that had it, a
/// vertex by its owner of before; both know all ranks within two edges, before (`held`) and now.
auto DistributedMesh::fresh_near(std::span<const int> before, const RankSets& held) const
    -> std::vector<Push> {
  const auto was_own = [&](VertexHandle v) { return before[v.idx()] == comm_.rank(); };
  std::vector<Push> pushes(comm_.n_ranks());
  RankSet now(near2_.words());
  for (std::size_t i = 0; i < mesh_.n_cells(); ++i) {
    const CellHandle c(i);
    if (mesh_.is_deleted(c)) continue;
    const auto& corners = mesh_.cell(c).v;
    if (std::none_of(corners.begin(), corners.end(), was_own)) continue;
    now.clear();
    for (VertexHandle v : corners) now.add(near2_[v.idx()]);
    for_ranks(now.bits(), [&](int rank) {
      if (rank == comm_.rank()) return;
      Push& push = pushes[static_cast<std::size_t>(rank)];
      const bool had_cell = std::any_of(corners.begin(), corners.end(),
                                        [&](VertexHandle v) { return held.has(v.idx(), rank); });
      if (!had_cell && was_own(*std::min_element(corners.begin(), corners.end()))) push.cells.push_back(c);
      for (VertexHandle v : corners)
        if (was_own(v) && (!had_cell || (near2_.has(v.idx(), rank) && !held.has(v.idx(), rank))))
          push.vertices.push_back(v);
    });
  }
  return pushes;
}

}  // namespace hfr::mpi
