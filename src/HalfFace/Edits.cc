// SPDX-License-Identifier: BSD-3-Clause
// Splits and collapses by hand. One rule serves the splits of edges, faces and cells: a cell that has the
// vertices s_0 … s_n that are cut becomes one part for each of them, in which a new vertex stands in its
// place. Part 0 keeps the cell's slot. For the collapse see the link condition of Dey, Edelsbrunner, Guha &
// Nekhayev, "Topology preserving edge contraction" (1999), with a further vertex behind the boundary.
#include <algorithm>
#include <string>

#include "HalfFace/Geometry.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr {
namespace {

/// An edge or face as it is once `old` is joined with or replaced by `now`.
template <std::size_t N>
std::array<VertexHandle, N> renamed(std::array<VertexHandle, N> vertices, VertexHandle old,
                                    VertexHandle now) {
  std::replace(vertices.begin(), vertices.end(), old, now);
  return vertices;
}

template <std::size_t N>
bool has(const std::array<VertexHandle, N>& vertices, VertexHandle v) {
  return std::find(vertices.begin(), vertices.end(), v) != vertices.end();
}

/// What is attached to `whole` goes to its parts, each with `middle` in the place of one of `simplex`.
template <std::size_t N, class T>
void split_entry(TupleMap<N, T>& map, const std::array<VertexHandle, N>& whole,
                 std::span<const VertexHandle> simplex, VertexHandle middle) {
  const std::size_t at = map.position(whole);
  if (at == map.size()) return;
  const auto entry = map.entries()[at];  // in the direction in which it was given
  map.rekey(whole, renamed(entry.vertices, simplex[0], middle));
  for (VertexHandle s : simplex.subspan(1)) map.set(renamed(entry.vertices, s, middle), entry.value);
}

/// Everything in the star of v that has v, each once, by ascending vertices.
struct StarParts {
  std::vector<std::array<VertexHandle, 2>> edges;
  std::vector<std::array<VertexHandle, 3>> faces;
  std::vector<std::array<VertexHandle, 4>> cells;
  std::vector<std::array<VertexHandle, 3>> boundary_faces;
  std::vector<std::array<VertexHandle, 2>> boundary_edges;

  StarParts(const TetMesh& mesh, const Star& star, VertexHandle v) {
    for (int i = 0; i < star.size; ++i) {
      const CellHandle c = star.cells[static_cast<std::size_t>(i)];
      const auto corners = mesh.cell_vertices(c, v);
      cells.push_back(AnyOrder::key(corners));
      for (VertexHandle w : corners)
        if (w != v) edges.push_back(AnyOrder::key(std::array{v, w}));
      for (HalfFaceHandle h : mesh.cell_halffaces(c)) {
        const auto f = mesh.halfface_vertices(h);
        if (!has(f, v)) continue;
        faces.push_back(AnyOrder::key(f));
        if (!mesh.is_boundary(h)) continue;
        boundary_faces.push_back(faces.back());
        for (VertexHandle w : f)
          if (w != v) boundary_edges.push_back(AnyOrder::key(std::array{v, w}));
      }
    }
    sort(edges);
    sort(faces);
    sort(cells);
    sort(boundary_faces);
    sort(boundary_edges);
  }

  static void sort(auto& items) {
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
  }
};

/// The link condition for v and w: what both would become the same must have been in a cell, or face of the
/// boundary, of both.
bool links_meet_in_their_edge(const StarParts& v_parts, const StarParts& w_parts, VertexHandle v,
                              VertexHandle w) {
  const auto contains = [](const auto& sorted, auto key) {
    return std::binary_search(sorted.begin(), sorted.end(), AnyOrder::key(key));
  };
  /// False when some item of v, renamed, is an item of w, and `spanned` does not have both together.
  const auto joins_only = [&](const auto& of_v, const auto& of_w, const auto& spanned) {
    return std::all_of(of_v.begin(), of_v.end(), [&](const auto& item) {
      if (has(item, w) || !contains(of_w, renamed(item, v, w))) return true;
      auto both = std::array<VertexHandle, std::tuple_size_v<std::remove_cvref_t<decltype(item)>> + 1>();
      std::copy(item.begin(), item.end(), both.begin());
      both.back() = w;
      return contains(spanned, both);
    });
  };
  const std::vector<std::array<VertexHandle, 5>> nothing;
  const std::vector<std::array<VertexHandle, 4>> no_cells;
  if (!joins_only(v_parts.edges, w_parts.edges, v_parts.faces)) return false;
  if (!joins_only(v_parts.faces, w_parts.faces, v_parts.cells)) return false;
  if (!joins_only(v_parts.cells, w_parts.cells, nothing)) return false;
  if (!joins_only(v_parts.boundary_edges, w_parts.boundary_edges, v_parts.boundary_faces)) return false;
  if (!joins_only(v_parts.boundary_faces, w_parts.boundary_faces, no_cells)) return false;
  return v_parts.boundary_edges.empty() || w_parts.boundary_edges.empty() ||
         contains(v_parts.boundary_edges, std::array{v, w});
}

/// True when no entry of v would meet another value at w, and what goes with the edge (v, w) has its like
/// among what stays.
template <std::size_t N>
bool can_join(const TupleMap<N, int>& map, const std::vector<std::array<VertexHandle, N>>& of_v,
              VertexHandle v, VertexHandle w) {
  if (map.empty()) return true;
  return std::all_of(of_v.begin(), of_v.end(), [&](const auto& item) {
    const int* label = map.find(item);
    if (!label) return true;
    if (has(item, w))
      return std::any_of(of_v.begin(), of_v.end(), [&](const auto& other) {
        const int* like = has(other, w) ? nullptr : map.find(other);
        return like && *like == *label;
      });
    const int* there = map.find(renamed(item, v, w));
    return !there || *there == *label;
  });
}

template <std::size_t N>
void join(TupleMap<N, int>& map, const std::vector<std::array<VertexHandle, N>>& of_v, VertexHandle v,
          VertexHandle w) {
  for (const auto& item : of_v) {
    if (map.empty()) return;
    const std::size_t at = map.position(item);
    if (at == map.size()) continue;
    const auto now = renamed(map.entries()[at].vertices, v, w);
    if (has(item, w) || map.find(now))
      map.erase_unordered(item);
    else
      map.rekey(item, now);
  }
}

}  // namespace

CellHandle TetMesh::take_slot(CellHandle like) {
  if (free_cells_.empty()) {
    grow_cells(cells_.size() + 1);
    free_cells_.push_back(CellHandle(cells_.size() - 1));
  }
  const CellHandle c = free_cells_.back();
  free_cells_.pop_back();
  copy_cell_data(like, c);
  return c;
}

void TetMesh::split_labels(const Cell& parent, std::span<const VertexHandle> simplex, VertexHandle middle) {
  const auto is_cut = [&](const auto& vertices) {
    return std::all_of(simplex.begin(), simplex.end(), [&](VertexHandle s) { return has(vertices, s); });
  };
  for (const auto& e : kEdgeCorners) {
    const std::array<VertexHandle, 2> edge = {parent.v[e[0]], parent.v[e[1]]};
    if (!is_cut(edge)) continue;
    split_entry(labels_.edges, edge, simplex, middle);
    split_entry(locks_.edges, edge, simplex, middle);
    for (VertexHandle s : simplex) properties_.inherit(edge, renamed(edge, s, middle));
  }
  for (const auto& f : kFaceCorners) {
    const std::array<VertexHandle, 3> face = {parent.v[f[0]], parent.v[f[1]], parent.v[f[2]]};
    if (!is_cut(face)) continue;
    split_entry(labels_.faces, face, simplex, middle);
    split_entry(locks_.faces, face, simplex, middle);
    for (VertexHandle s : simplex) properties_.inherit(face, renamed(face, s, middle));
  }
}

VertexHandle TetMesh::split(std::span<const CellHandle> parents, std::span<const VertexHandle> simplex,
                            Vec3 at) {
  if (cells_.size() + parents.size() * (simplex.size() - 1) >= kMostCells)
    throw ResourceLimit("split: no index is left for another cell");
  const VertexHandle nearest =
      *std::min_element(simplex.begin(), simplex.end(), [&](VertexHandle a, VertexHandle b) {
        return std::pair(norm2(point(a) - at), a) < std::pair(norm2(point(b) - at), b);
      });
  const VertexHandle middle = add_vertex(at);
  copy_vertex_data(nearest, middle);
  std::vector<Cell> old;
  std::vector<std::array<CellHandle, 4>> part(parents.size());
  for (std::size_t i = 0; i < parents.size(); ++i) {
    old.push_back(cell(parents[i]));
    part[i][0] = parents[i];
    for (std::size_t j = 1; j < simplex.size(); ++j) part[i][j] = take_slot(parents[i]);
  }
  const auto number = [&](CellHandle c) {
    return static_cast<std::size_t>(std::find(parents.begin(), parents.end(), c) - parents.begin());
  };
  for (std::size_t i = 0; i < parents.size(); ++i) {
    split_labels(old[i], simplex, middle);
    std::array<int, 4> corner{};  // of simplex[j]
    for (std::size_t j = 0; j < simplex.size(); ++j) corner[j] = old[i].corner(simplex[j]);
    for (std::size_t j = 0; j < simplex.size(); ++j) {
      const CellHandle c = part[i][j];
      Cell created = old[i];
      created.v[static_cast<std::size_t>(corner[j])] = middle;
      for (std::size_t r = 0; r < 4; ++r) {
        const HalfFaceHandle m = old[i].mate[r];
        const auto l = static_cast<std::size_t>(std::find(simplex.begin(), simplex.end(), old[i].v[r]) -
                                                simplex.begin());
        if (l == j) {  // an outer face, as it was
          if (m.is_valid()) cells_[m.idx() / 4].mate[m.idx() % 4] = halfface_of(c, static_cast<int>(r));
        } else if (l < simplex.size()) {  // between two parts
          created.mate[r] = halfface_of(part[i][l], corner[j]);
        } else if (m.is_valid()) {  // a part of a face that is cut on both sides
          created.mate[r] = halfface_of(part[number(cell_of(m))][j], corner_of(m));
        }
      }
      cells_[c.idx()] = created;
    }
    if (incident_cell_[simplex[0].idx()] == parents[i]) incident_cell_[simplex[0].idx()] = part[i][1];
    if (hand_index_state_ == kVoid) continue;
    count_cells();
    for (VertexHandle v : old[i].v) hand_index_.n_cells[v.idx()] += static_cast<Index>(simplex.size()) - 1;
    for (VertexHandle s : simplex) --hand_index_.n_cells[s.idx()];
    hand_index_.n_cells[middle.idx()] += static_cast<Index>(simplex.size());
  }
  incident_cell_[middle.idx()] = *std::min_element(parents.begin(), parents.end());
  outdate_hand_faces();
  return middle;
}

VertexHandle TetMesh::split_edge(EdgeHandle e, std::optional<Vec3> at) {
  HFR_REQUIRE(e.idx() / 6 < n_cells() && exists(e),
              "split_edge: edge " + std::to_string(e.idx()) + " does not exist");
  std::vector<CellHandle> parents;
  for (CellHandle c : edge_cells(e)) parents.push_back(c);
  const auto edge = edge_vertices(e);
  const auto value_of = [&](const auto& map) {
    const auto* found = map.find(edge);
    return found ? std::optional(*found) : std::nullopt;
  };
  const auto label = value_of(labels_.edges);
  const auto lock = value_of(locks_.edges);
  const VertexHandle middle = split(parents, edge, at ? *at : barycenter(*this, e));
  // Cells that are no part of this fan may have the whole edge still.
  if ((label || lock) && any_cell_has(edge)) {
    if (label) labels_.edges.set(edge, *label);
    if (lock) locks_.edges.set(edge, *lock);
  }
  return middle;
}

VertexHandle TetMesh::split_face(FaceHandle f, std::optional<Vec3> at) {
  HFR_REQUIRE(f.idx() / 4 < n_cells() && exists(f),
              "split_face: face " + std::to_string(f.idx()) + " does not exist");
  const auto parents = face_cells(f);
  return split({parents.begin(), parents.end()}, face_vertices(f), at ? *at : barycenter(*this, f));
}

VertexHandle TetMesh::split_cell(CellHandle c, std::optional<Vec3> at) {
  HFR_REQUIRE(exists(c), "split_cell: cell " + std::to_string(c.idx()) + " does not exist");
  const auto corners = cell_vertices(c);
  return split({&c, 1}, corners, at ? *at : barycenter(*this, c));
}

bool TetMesh::labels_can_join(const Star& star, VertexHandle v, VertexHandle w) const {
  if (is_fixed(v) || labels_.vertex(v) != 0) return false;
  if (labels_.edges.empty() && labels_.faces.empty() && locks_.empty()) return true;
  const StarParts parts(*this, star, v);
  const auto is_locked = [&](const auto& face) {
    const int* label = labels_.faces.find(face);
    return locks_.faces.find(face) || (label && locks_.patches.contains(*label));
  };
  if (std::any_of(parts.faces.begin(), parts.faces.end(), is_locked)) return false;
  if (std::any_of(parts.edges.begin(), parts.edges.end(),
                  [&](const auto& edge) { return locks_.edges.find(edge) != nullptr; }))
    return false;
  return can_join(labels_.edges, parts.edges, v, w) && can_join(labels_.faces, parts.faces, v, w);
}

void TetMesh::join_labels(const Star& star, VertexHandle v, VertexHandle w) {
  const StarParts parts(*this, star, v);
  join(labels_.edges, parts.edges, v, w);
  join(labels_.faces, parts.faces, v, w);
  if (!properties_.has_tuples()) return;
  Star star_of_w;
  gather_star(w, star_of_w);
  const StarParts parts_of_w(*this, star_of_w, w);
  // What w has keeps its value; for what it comes to have, there may be one of a thing that is gone.
  const auto hand_over = [&](const auto& of_v, const auto& of_w) {
    for (const auto& item : of_v) {
      if (has(item, w)) continue;
      const auto now = renamed(item, v, w);
      if (!std::binary_search(of_w.begin(), of_w.end(), AnyOrder::key(now))) properties_.replace(item, now);
    }
  };
  hand_over(parts.edges, parts_of_w.edges);
  hand_over(parts.faces, parts_of_w.faces);
}

bool TetMesh::is_collapse_ok(HalfEdgeHandle e) {
  HFR_REQUIRE(e.idx() / 12 < n_cells() && exists(e),
              "is_collapse_ok: half-edge " + std::to_string(e.idx()) + " does not exist");
  const auto [v, w] = halfedge_vertices(e);
  Star star_of_v, star_of_w;
  if (!gather_whole_star(v, star_of_v) || !gather_whole_star(w, star_of_w)) return false;
  return labels_can_join(star_of_v, v, w) &&
         links_meet_in_their_edge(StarParts(*this, star_of_v, v), StarParts(*this, star_of_w, w), v, w);
}

VertexHandle TetMesh::collapse_edge(HalfEdgeHandle e) {
  if (!is_collapse_ok(e)) return {};
  const auto [v, w] = halfedge_vertices(e);
  Star star;
  gather_star(v, star);
  join_labels(star, v, w);
  for (int i = 0; i < star.size; ++i) {
    const CellHandle c = star.cells[static_cast<std::size_t>(i)];
    const Cell k = cell(c);
    if (!k.has(w)) {
      cells_[c.idx()].v[k.own_corner(v)] = w;
      --hand_index_.n_cells[v.idx()];
      ++hand_index_.n_cells[w.idx()];
      continue;
    }
    // What lies behind the faces opposite v and w comes to lie on each other. By the link condition, one of
    // them is there.
    const HalfFaceHandle a = k.mate[k.own_corner(v)];
    const HalfFaceHandle b = k.mate[k.own_corner(w)];
    if (a.is_valid()) cells_[a.idx() / 4].mate[a.idx() % 4] = b;
    if (b.is_valid()) cells_[b.idx() / 4].mate[b.idx() % 4] = a;
    for (VertexHandle u : k.v) {
      --hand_index_.n_cells[u.idx()];
      if (u == v || incident_cell_[u.idx()] != c) continue;
      CellHandle next;
      for (HalfFaceHandle m : {a, b})
        if (m.is_valid()) next = std::min(next, cell_of(m));
      incident_cell_[u.idx()] = next;
    }
    cells_[c.idx()] = Cell{};
    free_cells_.push_back(c);
  }
  mark_deleted(v);
  outdate_hand_faces();
  return w;
}

}  // namespace hfr
