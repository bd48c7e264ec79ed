// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Edits.hh"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "HalfFace/Geometry.hh"
#include "Transfer/Locate.hh"
#include "Transfer/Overlaps.hh"

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

void place(const TetMesh& old, const Edits& edits, std::vector<PlacedVertex>& vertices, par::Policy policy) {
  constexpr double kNanoseconds = 2'000;  // a vertex, about
  par::for_each_dynamic(policy.for_items_of(kNanoseconds), vertices.size(), 64, [&](std::size_t i) {
    PlacedVertex& v = vertices[i];
    const Place at = locate(old, v.point, edits.maps.sources[v.vertex.idx()]);
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

/// The largest share first; of equal ones the smaller handle.
void set_parents(const TetMesh& old, const TetMesh& now, Edits& edits, par::Policy policy) {
  std::vector<CellHandle> cells;
  for (const CreatedCell& c : edits.created_cells) cells.push_back(c.cell);
  const Overlaps overlaps = find_overlaps(old, now, edits, cells, changed_old_cells(edits), policy);
  edits.has_parents = true;
  edits.parents.reserve(overlaps.parts.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    CreatedCell& c = edits.created_cells[i];
    c.first_parent = edits.parents.size();
    const double whole = volume(now, c.cell);
    for (const Overlap& part : overlaps.of(i))
      edits.parents.push_back({part.old_cell, part.volume / (whole < 0 ? -whole : whole)});
    c.n_parents = edits.parents.size() - c.first_parent;
    std::stable_sort(edits.parents.begin() + static_cast<std::ptrdiff_t>(c.first_parent), edits.parents.end(),
                     [](const ParentCell& a, const ParentCell& b) { return a.share > b.share; });
  }
}

}  // namespace

Edits make_edits(const TetMesh& old, const TetMesh& now, MeshMaps maps, par::Policy policy,
                 bool with_parents) {
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
                                    .old_cell = {}});
  edits.moved_cells = cells_that_moved(now, edits, policy);
  place(old, edits, edits.created_vertices, policy);
  place(old, edits, edits.moved_vertices, policy);
  if (with_parents) set_parents(old, now, edits, policy);
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
