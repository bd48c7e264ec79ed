// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Cavity.hh"

#include <algorithm>
#include <limits>

namespace hfr {
namespace {

/// Distinct edges and faces of a set of tetrahedra. Sorted arrays, so that a set of a few dozen cells costs a
/// few microseconds; only plans that are about to be accepted come here.
template <std::size_t N>
class SimplexSet {
 public:
  void add(std::array<VertexHandle, N> key) {
    std::sort(key.begin(), key.end());
    items_.push_back(key);
  }
  void finish() {
    std::sort(items_.begin(), items_.end());
    items_.resize(static_cast<std::size_t>(std::unique(items_.begin(), items_.end()) - items_.begin()));
  }
  bool has(const std::array<VertexHandle, N>& key) const {
    return std::binary_search(items_.begin(), items_.end(), key);
  }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }

 private:
  FixedVector<std::array<VertexHandle, N>, 6 * Cavity::kCapacity> items_;
};

template <class Cells>
SimplexSet<2> edges_of(const Cells& tets) {
  SimplexSet<2> set;
  for (const Tet& t : tets)
    for (const auto& e : kEdgeCorners) set.add({t[e[0]], t[e[1]]});
  set.finish();
  return set;
}

template <class Cells>
SimplexSet<3> faces_of(const Cells& tets) {
  SimplexSet<3> set;
  for (const Tet& t : tets)
    for (const auto& f : kFaceCorners) set.add({t[f[0]], t[f[1]], t[f[2]]});
  set.finish();
  return set;
}

FixedVector<Tet, Cavity::kCapacity> dead_tets(const TetMesh& mesh, const Cavity& cavity) {
  FixedVector<Tet, Cavity::kCapacity> tets;
  for (CellHandle c : cavity.dead) tets.push_back(mesh.cell(c).v);
  return tets;
}

/// True when the outer faces are a sphere. Where they touch themselves along an edge or in a vertex, which a
/// cavity that grows among inverted cells may do, new cells can tear the cells round it into two groups.
bool is_ball(const TetMesh& mesh, const Cavity& cavity) {
  FixedVector<std::array<VertexHandle, 2>, 6 * Cavity::kCapacity> edges;
  FixedVector<VertexHandle, 6 * Cavity::kCapacity> vertices;
  std::size_t n_faces = 0;
  for (CellHandle c : cavity.dead) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (m.is_valid() && std::find(cavity.dead.begin(), cavity.dead.end(), cell_of(m)) != cavity.dead.end())
        continue;
      ++n_faces;
      const auto f = mesh.halfface_vertices(h);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(f[i], f[(i + 1) % 3]);
        edges.push_back({low, high});
        vertices.push_back(f[i]);
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i + 2 < edges.size(); ++i)
    if (edges[i] == edges[i + 2]) return false;
  std::sort(vertices.begin(), vertices.end());
  const auto n_vertices =
      static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) - vertices.begin());
  return n_vertices + n_faces == edges.size() / 2 + 2;  // Euler's number of a sphere
}

bool labels_survive(const TetMesh& mesh, const Cavity& cavity) {
  const Labels& labels = mesh.labels();
  const Locks& locks = mesh.locks();
  if (!labels.faces.empty() || !locks.faces.empty()) {
    for (CellHandle c : cavity.dead) {
      for (int k = 0; k < 4; ++k) {
        const HalfFaceHandle h = halfface_of(c, k);
        const HalfFaceHandle m = mesh.opposite_halfface(h);
        if (!m.is_valid() || m < h) continue;
        const auto first = cavity.dead.begin() + static_cast<std::ptrdiff_t>(cavity.n_dead_first);
        const auto other = std::find(cavity.dead.begin(), cavity.dead.end(), cell_of(m));
        // What an interface is labelled with is the surface's to keep.
        const bool is_first = std::find(cavity.dead.begin(), first, c) != first;
        const bool inside = other != cavity.dead.end() && is_first == (other < first);
        const auto face = mesh.halfface_vertices(h);
        if (inside && (labels.faces.find(face) || locks.faces.find(face))) return false;
      }
    }
  }
  if (!labels.edges.empty() || !locks.edges.empty()) {
    const SimplexSet<2> kept = edges_of(cavity.born);
    for (const auto& edge : edges_of(dead_tets(mesh, cavity)))
      if (!kept.has(edge) && (labels.edges.find(edge) || locks.edges.find(edge))) return false;
  }
  return !cavity.removed.is_valid() || labels.vertex(cavity.removed) == 0;
}

/// True when some cell has all the vertices. Each of them is asked: the star of a vertex whose cells do not
/// connect through faces is only known in part.
bool exists(const TetMesh& mesh, const std::array<VertexHandle, 2>& edge, Star& scratch) {
  return mesh.has_edge(edge[0], edge[1], scratch) || mesh.has_edge(edge[1], edge[0], scratch);
}
bool exists(const TetMesh& mesh, const std::array<VertexHandle, 3>& face, Star& scratch) {
  return mesh.has_face(face[0], face[1], face[2], scratch) ||
         mesh.has_face(face[1], face[2], face[0], scratch) ||
         mesh.has_face(face[2], face[0], face[1], scratch);
}

}  // namespace

bool admissible(const TetMesh& mesh, const Cavity& cavity, bool check_links, Star& scratch) {
  if (cavity.moved.is_valid()) return true;
  if (mesh.has_regions()) {
    for (std::size_t i = 0; i < cavity.dead.size(); ++i) {
      const std::size_t first = i < cavity.n_dead_first ? 0 : cavity.n_dead_first;
      if (mesh.region(cavity.dead[i]) != mesh.region(cavity.dead[first])) return false;
    }
  }
  if (!labels_survive(mesh, cavity)) return false;
  if (!check_links) return true;
  if (!is_ball(mesh, cavity)) return false;

  const auto before = dead_tets(mesh, cavity);
  const SimplexSet<2> old_edges = edges_of(before);
  const SimplexSet<3> old_faces = faces_of(before);
  for (const auto& edge : edges_of(cavity.born)) {
    if (old_edges.has(edge) || edge[1] == Cavity::kNewVertex) continue;
    if (exists(mesh, edge, scratch)) return false;
  }
  for (const auto& face : faces_of(cavity.born)) {
    if (old_faces.has(face) || face[2] == Cavity::kNewVertex) continue;
    // A face with a new edge is new with it; what is left has three old edges.
    if (!old_edges.has({face[0], face[1]}) || !old_edges.has({face[0], face[2]}) ||
        !old_edges.has({face[1], face[2]}))
      continue;
    if (exists(mesh, face, scratch)) return false;
  }
  return true;
}

VertexHandle nearest_vertex(const TetMesh& mesh, const Cavity& cavity) {
  VertexHandle nearest;
  double least = std::numeric_limits<double>::infinity();
  for (CellHandle c : cavity.dead) {
    for (VertexHandle v : mesh.cell(c).v) {
      const double distance = norm2(mesh.point(v) - *cavity.new_vertex);
      if (distance < least || (distance == least && v < nearest)) {
        least = distance;
        nearest = v;
      }
    }
  }
  return nearest;
}

std::size_t created_simplices(const TetMesh& mesh, const Cavity& cavity, std::span<Simplex> out) {
  if (cavity.moved.is_valid() || cavity.new_vertex) return 0;
  const auto before = dead_tets(mesh, cavity);
  std::size_t n = 0;
  const auto emit = [&](const Simplex& simplex) {
    if (n < out.size()) out[n++] = simplex;
  };
  const SimplexSet<2> old_edges = edges_of(before);
  for (const auto& edge : edges_of(cavity.born))
    if (!old_edges.has(edge)) emit({edge[0], edge[1], VertexHandle()});
  const SimplexSet<3> old_faces = faces_of(before);
  for (const auto& face : faces_of(cavity.born))
    if (!old_faces.has(face) && old_edges.has({face[0], face[1]}) && old_edges.has({face[0], face[2]}) &&
        old_edges.has({face[1], face[2]}))
      emit(face);
  return n;
}

}  // namespace hfr
