// SPDX-License-Identifier: BSD-3-Clause
// Where a part meets others: who is near to whom, kept up to date round what has changed.
#include <algorithm>
#include <utility>

#include "Distributed/DistributedMesh.hh"
#include "Distributed/Near.hh"
#include "Distributed/WholeStars.hh"

namespace hfr::mpi {
namespace {

constexpr std::size_t kPurgeShare = 16;  // of the zone: so many changes, and it is looked through
// Of the zone: where vertices are fewer, their cells are found by walks, each of which sees some 24 of them.
constexpr std::size_t kWalkShare = 64;

}  // namespace

/// Sets of vertices further than two edges from others' are their owner's alone.
void DistributedMesh::start_zone() {
  const std::size_t n = mesh_.n_vertices(), n_cells = mesh_.n_cells();
  near1_ = near2_ = RankSets(n, comm_.size());
  std::vector<std::uint8_t> steps(n, 0);  // 1: another's; 2, 3: one and two edges from such
  for (std::size_t v = 0; v < n; ++v) {
    near1_.set_only(v, owner_[v]);
    near2_.set_only(v, owner_[v]);
    steps[v] = owner_[v] == comm_.rank() ? 0 : 1;
  }
  zone_.clear();
  for (std::uint8_t step = 1; step <= 3; ++step)
    for (std::size_t c = 0; c < n_cells; ++c) {
      if (mesh_.is_deleted(CellHandle(c))) continue;
      const auto& v = mesh_.cell(CellHandle(c)).v;
      if (std::none_of(v.begin(), v.end(),
                       [&](VertexHandle u) { return steps[u.idx()] != 0 && steps[u.idx()] <= step; }))
        continue;
      if (step == 3)
        zone_.push_back(static_cast<Index>(c));
      else
        for (VertexHandle u : v)
          if (steps[u.idx()] == 0) steps[u.idx()] = static_cast<std::uint8_t>(step + 1);
    }
  find_near(
      mesh_, zone_, [&](VertexHandle v) { return owner(v); }, near1_, near2_);
  in_zone_.assign(n_cells, 0);
  rim_.clear();
  for (Index c : zone_) {
    in_zone_[c] = 1;
    const auto& v = mesh_.cell(CellHandle(c)).v;
    if (std::none_of(v.begin(), v.end(), [&](VertexHandle u) { return is_own(u); })) rim_.push_back(c);
  }
  open_.clear();
  dirty_.clear();
  n_changed_in_zone_ = 0;
  renewed_.clear();
  marks_.assign(n, 0);
  told_ = near2_;
}

void DistributedMesh::put_into_zone(CellHandle c) {
  if (in_zone_.size() < mesh_.n_cells()) in_zone_.resize(mesh_.n_cells(), 0);
  if (std::exchange(in_zone_[c.idx()], std::uint8_t{1}) == 0) zone_.push_back(c.idx());
}

void DistributedMesh::note_created(CellHandle c) {
  const auto& v = mesh_.cell(c).v;
  put_into_zone(c);
  note_changed(v);
  if (std::none_of(v.begin(), v.end(), [&](VertexHandle u) { return is_own(u); })) rim_.push_back(c.idx());
}

/// Those of the zone that have one of these vertices, each of which is there once; of a vertex that is
/// further than two edges from own ones maybe not all. O(zone), or less where vertices are few.
std::vector<Index> DistributedMesh::zone_round(std::span<const VertexHandle> vertices) {
  const auto has_incident = [&](VertexHandle v) {
    const CellHandle c = mesh_.incident_cell(v);
    return c.is_valid() && !mesh_.is_deleted(c) && mesh_.cell(c).has(v);
  };
  // Whether a vertex is pinched, and where it has cells, is known of those within two edges, as far as that
  // was known before.
  const auto is_found_by_walk = [&](VertexHandle v) {
    const bool is_near = near2_.has(v.idx(), comm_.rank());
    if (!work_.pinched.empty() && (!is_near || work_.pinched[v.idx()] != 0)) return false;
    return has_incident(v) || mesh_.is_deleted(v) || !is_near;
  };
  if (vertices.size() < zone_.size() / kWalkShare &&
      std::all_of(vertices.begin(), vertices.end(), is_found_by_walk)) {
    Marks& marks = cell_marks();
    for (VertexHandle v : vertices) {
      if (!has_incident(v)) continue;
      for (CellHandle c : mesh_.vertex_cells(v))
        if (is_in_zone(c)) marks.add(c.idx());
    }
    return marks.take<Index>();
  }
  for (VertexHandle v : vertices) marks_[v.idx()] = 1;
  std::vector<Index> cells;
  for (Index c : zone_) {
    if (mesh_.is_deleted(CellHandle(c))) continue;
    const auto& v = mesh_.cell(CellHandle(c)).v;
    if (marks_[v[0].idx()] | marks_[v[1].idx()] | marks_[v[2].idx()] | marks_[v[3].idx()]) cells.push_back(c);
  }
  for (VertexHandle v : vertices) marks_[v.idx()] = 0;
  return cells;
}

/// Sets of these vertices as fill(vertex, neighbour) makes them, which is called for all edges of them in
/// cells of the zone; `cells`: from zone_round(). Returns those whose sets are others than before.
template <class Fill>
std::vector<VertexHandle> DistributedMesh::renew(RankSets& sets, std::span<const VertexHandle> vertices,
                                                 std::span<const Index> cells, Fill&& fill) {
  std::vector<RankSets::Id> before;
  before.reserve(vertices.size());
  for (VertexHandle v : vertices) {
    before.push_back(sets.id(v.idx()));
    sets.set_only(v.idx(), owner(v));
    marks_[v.idx()] = 1;
  }
  for (Index c : cells) {
    const auto& corners = mesh_.cell(CellHandle(c)).v;
    for (VertexHandle u : corners)
      if (marks_[u.idx()])
        for (VertexHandle w : corners) fill(u, w);
  }
  for (VertexHandle v : vertices) marks_[v.idx()] = 0;
  std::vector<VertexHandle> others;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (sets.id(vertices[i].idx()) != before[i]) others.push_back(vertices[i]);
  return others;
}

/// Cells that are not in the zone have inside vertices only, so they add nothing to a set but this rank.
void DistributedMesh::update_zone() {
  std::vector<VertexHandle> vertices;  // each once
  for (VertexHandle v : dirty_)
    if (std::exchange(marks_[v.idx()], std::uint8_t{1}) == 0) vertices.push_back(v);
  for (VertexHandle v : vertices) marks_[v.idx()] = 0;
  dirty_.clear();
  if (vertices.empty()) return;
  n_changed_in_zone_ += vertices.size();
  WholeStars stars(mesh_, work_);
  const auto put_star = [&](VertexHandle v) {
    if (!mesh_.is_deleted(v)) stars.for_cells(v, [&](CellHandle c) { put_into_zone(c); });
  };
  std::vector<Index> cells = zone_round(vertices);
  const auto nearer =
      renew(near1_, vertices, cells, [&](VertexHandle u, VertexHandle w) { near1_.add(u.idx(), owner(w)); });
  if (!nearer.empty()) {
    for (VertexHandle v : nearer)
      if (is_own(v) && is_inside(v)) put_star(v);
    // Within two edges: the same vertices, and the neighbours of those that are near to others now.
    std::vector<std::uint8_t> is_in(mesh_.n_vertices(), 0);
    for (VertexHandle v : vertices) is_in[v.idx()] = 1;
    for (Index c : zone_round(nearer))
      for (VertexHandle v : mesh_.cell(CellHandle(c)).v)
        if (std::exchange(is_in[v.idx()], std::uint8_t{1}) == 0) vertices.push_back(v);
    cells = zone_round(vertices);
  }
  std::vector<VertexHandle> was_inside;
  for (VertexHandle v : vertices)
    if (is_own(v) && is_inside(v)) was_inside.push_back(v);
  const auto renewed = renew(near2_, vertices, cells,
                             [&](VertexHandle u, VertexHandle w) { near2_.add(u.idx(), near1_[w.idx()]); });
  for (VertexHandle v : was_inside)
    if (!is_inside(v)) put_star(v);
  for (VertexHandle v : renewed)
    if (is_own(v)) renewed_.push_back(v);
  if (n_changed_in_zone_ < zone_.size() / kPurgeShare) return;
  n_changed_in_zone_ = 0;
  std::erase_if(zone_, [&](Index c) {
    const auto& v = mesh_.cell(CellHandle(c)).v;
    const bool goes = mesh_.is_deleted(CellHandle(c)) ||
                      std::all_of(v.begin(), v.end(), [&](VertexHandle u) { return is_inside(u); });
    if (goes) in_zone_[c] = 0;
    return goes;
  });
}

void DistributedMesh::note_told() {
  for (VertexHandle v : renewed_) told_.set(v.idx(), near2_[v.idx()]);
  renewed_.clear();
}

void DistributedMesh::prune() {
  std::erase_if(rim_, [&](Index i) {
    const CellHandle c(i);
    if (mesh_.is_deleted(c)) return true;
    const auto& v = mesh_.cell(c).v;
    if (std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return near2_.has(u.idx(), comm_.rank()); }))
      return false;
    detach(c);
    return true;
  });
  open_.clear();  // behind them is nothing that this part holds
}

}  // namespace hfr::mpi
