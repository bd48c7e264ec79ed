// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Edits.hh"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "HalfFace/Errors.hh"
#include "Transfer/Locate.hh"
#include "Transfer/NearVertex.hh"
#include "Transfer/Overlaps.hh"
#include "Transfer/Stars.hh"

namespace hfr {
namespace {

/// Takes cells out of the maps whose vertices have another order now: what a user keeps for each corner of a
/// cell would be mixed up.
void keep_cells_of_same_order(const TetMesh& old, const TetMesh& now, MeshMaps& maps, par::Policy policy) {
  par::for_each(policy, maps.cells.size(), [&](std::size_t i) {
    const CellHandle c = maps.cells[i];
    if (!c.is_valid()) return;
    const auto& was = old.cell_vertices(CellHandle(i));
    const auto& is = now.cell_vertices(c);
    for (std::size_t k = 0; k < 4; ++k) {
      if (maps.vertices[was[k].idx()] == is[k]) continue;
      maps.old_cells[c.idx()] = CellHandle();
      maps.cells[i] = CellHandle();
      return;
    }
  });
}

template <class H>
std::vector<H> unmapped(const std::vector<H>& map, par::Policy policy) {
  std::vector<H> out;
  for (Index i : par::compact<Index>(policy, map.size(), [&](std::size_t k) { return !map[k].is_valid(); }))
    out.push_back(H(i));
  return out;
}

/// From old vertices inwards, a layer of neighbours after the other.
void find_near_vertices(const TetMesh& now, const MeshMaps& maps, std::vector<PlacedVertex>& created,
                        par::Policy policy) {
  if (created.empty()) return;
  std::vector<VertexHandle> vertices;
  for (const PlacedVertex& v : created) vertices.push_back(v.vertex);
  const Stars stars(now, vertices, policy);
  std::vector<VertexHandle> near = maps.old_vertices;  // by new vertex
  std::vector<std::pair<VertexHandle, VertexHandle>> layer;
  do {
    layer.clear();
    for (PlacedVertex& v : created) {
      if (v.near_vertex.is_valid()) continue;
      const VertexHandle u = neighbour_with_near_vertex(
          now, v.vertex, stars.of(v.vertex), [&](VertexHandle w) { return near[w.idx()].is_valid(); });
      if (!u.is_valid()) continue;
      v.near_vertex = near[u.idx()];
      layer.emplace_back(v.vertex, v.near_vertex);
    }
    for (const auto& [v, is_near] : layer) near[v.idx()] = is_near;
  } while (!layer.empty());
}

void place(const TetMesh& old, const Stars& stars, std::vector<PlacedVertex>& vertices, par::Policy policy) {
  constexpr double kNanoseconds = 2'000;  // a vertex, about
  par::for_each_dynamic(policy.for_items_of(kNanoseconds), vertices.size(), 64, [&](std::size_t i) {
    PlacedVertex& v = vertices[i];
    const Place at = locate(old, v.point, stars.of(v.near_vertex));
    v.old_cell = at.cell;
    v.weights = at.weights;
    v.inside = at.inside;
  });
}

/// Mapped cells with a vertex that has moved, ascending.
std::vector<CellHandle> cells_that_moved(const TetMesh& now, const Edits& edits, par::Policy policy) {
  std::vector<CellHandle> cells;
  if (edits.moved_vertices.empty()) return cells;
  std::vector<std::uint8_t> has_moved(now.n_vertices(), 0);
  for (const PlacedVertex& v : edits.moved_vertices) has_moved[v.vertex.idx()] = 1;
  for (Index i : par::compact<Index>(policy, now.n_cells(), [&](std::size_t c) {
         const auto& v = now.cell_vertices(CellHandle(c));
         return (has_moved[v[0].idx()] | has_moved[v[1].idx()] | has_moved[v[2].idx()] |
                 has_moved[v[3].idx()]) != 0 &&
                edits.maps.old_cells[c].is_valid();
       }))
    cells.push_back(CellHandle(i));
  return cells;
}

/// The created cells of the edits, with where their corners are.
std::vector<NewCell> shapes_of_created(const TetMesh& old, const Edits& edits) {
  const auto point = [&](VertexHandle v) {
    for (const auto* list : {&edits.moved_vertices, &edits.created_vertices}) {
      const auto at = std::lower_bound(list->begin(), list->end(), v,
                                       [](const PlacedVertex& p, VertexHandle u) { return p.vertex < u; });
      if (at != list->end() && at->vertex == v) return at->point;
    }
    return old.point(edits.maps.old_vertices[v.idx()]);
  };
  std::vector<NewCell> cells;
  cells.reserve(edits.created_cells.size());
  for (const CreatedCell& c : edits.created_cells) {
    const auto& v = c.vertices;
    cells.push_back({.vertices = v, .points = {point(v[0]), point(v[1]), point(v[2]), point(v[3])}});
  }
  add_starts(edits, cells);
  return cells;
}

}  // namespace

struct Edits::ParentSearch {
  std::mutex mutex;
  std::shared_ptr<const TetMesh> old;  // until they are found
  par::Policy policy;
  std::optional<Parents> found;
  Overlaps overlaps;  // that they were made of
};

Parents parents_of(std::span<const NewCell> cells, const Overlaps& overlaps, par::Policy policy) {
  Parents parents;
  parents.all.resize(overlaps.parts.size());
  par::for_each(policy, cells.size(), [&](std::size_t i) {
    const double whole = std::abs(volume6(cells[i].points)) / 6;
    ParentCell* const begin = parents.all.data() + overlaps.first[i];
    ParentCell* end = begin;
    for (const Overlap& part : overlaps.of(i)) *end++ = {part.old_cell, part.volume / whole};
    std::sort(begin, end, [](const ParentCell& a, const ParentCell& b) {
      return a.share > b.share || (a.share == b.share && a.old_cell < b.old_cell);
    });
  });
  parents.first = overlaps.first;
  return parents;
}

const Parents& Edits::parents() const {
  HFR_REQUIRE(search_, "parents of created cells were left out of the edits");
  const std::scoped_lock lock(search_->mutex);
  if (!search_->found) {
    const std::vector<NewCell> cells = shapes_of_created(*search_->old, *this);
    search_->overlaps = find_overlaps(*search_->old, cells, changed_old_cells(*this), search_->policy);
    search_->found = parents_of(cells, search_->overlaps, search_->policy);
    search_->old.reset();
  }
  return *search_->found;
}

const Overlaps* overlaps_of_created(const Edits& edits) {
  if (!edits.has_parents()) return nullptr;
  edits.parents();
  return &edits.search_->overlaps;
}

Edits make_edits(std::shared_ptr<const TetMesh> old, const TetMesh& now, MeshMaps maps, par::Policy policy) {
  Edits edits = make_edits(*old, now, std::move(maps), policy);
  edits.search_ = std::make_shared<Edits::ParentSearch>();
  edits.search_->old = std::move(old);
  edits.search_->policy = policy;
  return edits;
}

Edits make_edits(const TetMesh& old, const TetMesh& now, MeshMaps maps, par::Policy policy) {
  Edits edits;
  keep_cells_of_same_order(old, now, maps, policy);
  edits.maps = std::move(maps);
  edits.removed_cells = unmapped(edits.maps.cells, policy);
  edits.removed_vertices = unmapped(edits.maps.vertices, policy);
  for (CellHandle c : unmapped(edits.maps.old_cells, policy))
    edits.created_cells.push_back({c, now.cell_vertices(c)});
  for (VertexHandle v : unmapped(edits.maps.old_vertices, policy))
    edits.created_vertices.push_back({.vertex = v, .old_vertex = {}, .point = now.point(v), .old_cell = {}});
  const auto& was = edits.maps.old_vertices;
  const auto has_moved = [&](VertexHandle v) {
    return was[v.idx()].is_valid() && !(now.point(v) == old.point(was[v.idx()]));
  };
  for (Index i :
       par::compact<Index>(policy, was.size(), [&](std::size_t v) { return has_moved(VertexHandle(v)); }))
    edits.moved_vertices.push_back({.vertex = VertexHandle(i),
                                    .old_vertex = was[i],
                                    .point = now.point(VertexHandle(i)),
                                    .old_cell = {},
                                    .near_vertex = was[i]});
  edits.moved_cells = cells_that_moved(now, edits, policy);
  find_near_vertices(now, edits.maps, edits.created_vertices, policy);
  std::vector<VertexHandle> near;
  for (auto* list : {&edits.created_vertices, &edits.moved_vertices})
    for (const PlacedVertex& v : *list) near.push_back(v.near_vertex);
  const Stars stars(old, near, policy);
  place(old, stars, edits.created_vertices, policy);
  place(old, stars, edits.moved_vertices, policy);
  return edits;
}

std::vector<std::array<VertexHandle, 4>> Edits::cell_vertices(
    std::span<const std::array<VertexHandle, 4>> old) const {
  auto now = cell_values<std::array<VertexHandle, 4>>(old, [](const CreatedCell& c) { return c.vertices; });
  for (std::size_t i = 0; i < now.size(); ++i)
    if (maps.old_cells[i].is_valid())
      for (VertexHandle& v : now[i]) v = maps.vertices[v.idx()];
  return now;
}

std::vector<Vec3> Edits::points(std::span<const Vec3> old) const {
  return vertex_values<Vec3>(old, [](const PlacedVertex& v) { return v.point; });
}

}  // namespace hfr
