// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Cavity.hh"

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>

#include "HalfFace/Errors.hh"
#include "Operators/PinchedStars.hh"
#include "Parallel/DisjointSets.hh"
#include "Quality/Damage.hh"

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

FixedVector<Tet, Cavity::kCapacity> removed_tets(const TetMesh& mesh, const Cavity& cavity) {
  FixedVector<Tet, Cavity::kCapacity> tets;
  for (CellHandle c : cavity.removed) tets.push_back(mesh.cell(c).v);
  return tets;
}

/// True when the outer faces are a sphere. Where they touch themselves along an edge or in a vertex, which a
/// cavity that grows among inverted cells may do, new cells can tear the cells round it into two groups. Two
/// spheres that touch in two vertices have Euler's number of one, and are told by their faces.
bool is_ball(const TetMesh& mesh, const Cavity& cavity) {
  struct Side {
    std::array<VertexHandle, 2> edge;
    std::uint32_t face;
    bool operator<(const Side& other) const {
      return std::tie(edge, face) < std::tie(other.edge, other.face);
    }
  };
  FixedVector<Side, 6 * Cavity::kCapacity> sides;
  FixedVector<VertexHandle, 6 * Cavity::kCapacity> vertices;
  std::size_t n_faces = 0;
  for (CellHandle c : cavity.removed) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (m.is_valid() &&
          std::find(cavity.removed.begin(), cavity.removed.end(), cell_of(m)) != cavity.removed.end())
        continue;
      const auto face = static_cast<std::uint32_t>(n_faces++);
      const auto f = mesh.halfface_vertices(h);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(f[i], f[(i + 1) % 3]);
        sides.push_back({{low, high}, face});
        vertices.push_back(f[i]);
      }
    }
  }
  std::sort(sides.begin(), sides.end());
  par::DisjointSets<std::uint32_t> faces(n_faces);
  std::size_t n_pieces = n_faces;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].edge != sides[i + 1].edge) continue;
    if (i + 2 < sides.size() && sides[i].edge == sides[i + 2].edge) return false;
    if (faces.join(sides[i].face, sides[i + 1].face)) --n_pieces;
  }
  std::sort(vertices.begin(), vertices.end());
  const auto n_vertices =
      static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) - vertices.begin());
  return n_pieces == 1 && n_vertices + n_faces == sides.size() / 2 + 2;  // Euler's number of a sphere
}

/// Whether an edge or face may have a label or be fixed: then all its vertices are constrained.
template <std::size_t N>
bool may_be_labelled(const std::array<VertexHandle, N>& simplex, const StarKnowledge& known) {
  return known.constrained.empty() || std::all_of(simplex.begin(), simplex.end(), [&](VertexHandle v) {
           return known.constrained[v.idx()] != 0;
         });
}

bool faces_survive(const TetMesh& mesh, const Cavity& cavity, const StarKnowledge& known) {
  const auto& labels = mesh.labels().faces;
  const auto& locks = mesh.locks().faces;
  if (labels.empty() && locks.empty()) return true;
  const auto first = cavity.removed.begin() + static_cast<std::ptrdiff_t>(cavity.n_removed_first);
  for (CellHandle c : cavity.removed) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (!m.is_valid() || m < h) continue;
      const auto face = mesh.halfface_vertices(h);
      if (!may_be_labelled(face, known)) continue;
      const auto other = std::find(cavity.removed.begin(), cavity.removed.end(), cell_of(m));
      // See find_heirs() for what an interface is labelled with.
      const bool is_first = std::find(cavity.removed.begin(), first, c) != first;
      const bool inside = other != cavity.removed.end() && is_first == (other < first);
      if (inside && (labels.find(face) || locks.find(face))) return false;
    }
  }
  return true;
}

bool edges_survive(const TetMesh& mesh, const Cavity& cavity, const StarKnowledge& known) {
  const auto& labels = mesh.labels().edges;
  const auto& locks = mesh.locks().edges;
  if (labels.empty() && locks.empty()) return true;
  for (CellHandle c : cavity.removed) {
    const auto& v = mesh.cell(c).v;
    for (const auto& ends : kEdgeCorners) {
      const std::array<VertexHandle, 2> edge = {v[ends[0]], v[ends[1]]};
      if (!may_be_labelled(edge, known) || !(labels.find(edge) || locks.find(edge))) continue;
      const auto has_edge = [&](const Tet& t) {
        return std::count(t.begin(), t.end(), edge[0]) + std::count(t.begin(), t.end(), edge[1]) == 2;
      };
      if (std::none_of(cavity.created.begin(), cavity.created.end(), has_edge)) return false;
    }
  }
  return true;
}

bool labels_survive(const TetMesh& mesh, const Cavity& cavity, const StarKnowledge& known) {
  return faces_survive(mesh, cavity, known) && edges_survive(mesh, cavity, known) &&
         (!cavity.removed_vertex.is_valid() || mesh.labels().vertex(cavity.removed_vertex) == 0);
}

/// False only when it is sure that no cell has all the vertices.
template <std::size_t N>
bool may_exist(const TetMesh& mesh, const std::array<VertexHandle, N>& wanted, const StarKnowledge& known,
               Star& scratch) {
  const auto has_all = [&](CellHandle c) {
    const Cell& cell = mesh.cell(c);
    return std::all_of(wanted.begin(), wanted.end(), [&](VertexHandle v) { return cell.has(v); });
  };
  std::span<const CellHandle> listed;  // the fewest; a vertex with a whole small star knows it sooner
  for (VertexHandle v : wanted) {
    if (!mesh.incident_cell(v).is_valid()) return false;
    if (known.pinched) {
      const std::span<const CellHandle> all = known.pinched->cells(v);
      if (!all.empty() && (listed.empty() || all.size() < listed.size())) listed = all;
      if (!all.empty()) continue;
    }
    if (!mesh.gather_star(v, scratch)) continue;  // too large
    const std::span<const CellHandle> star(scratch.cells.data(), static_cast<std::size_t>(scratch.size));
    if (std::any_of(star.begin(), star.end(), has_all)) return true;
    const bool is_all =
        !known.star_size.empty() && known.star_size[v.idx()] == static_cast<std::uint32_t>(scratch.size);
    if (is_all) return false;
  }
  if (!listed.empty()) return std::any_of(listed.begin(), listed.end(), has_all);
  if (!known.star_size.empty()) return true;
  for (std::size_t i = 0; i < mesh.n_cells(); ++i)
    if (!mesh.is_deleted(CellHandle(i)) && has_all(CellHandle(i))) return true;
  return false;
}

bool has_face_of_three_cells(const Cavity& cavity) {
  FixedVector<std::array<VertexHandle, 3>, 4 * Cavity::kCapacity> faces;
  for (const Tet& t : cavity.created)
    for (const auto& f : kFaceCorners) faces.push_back(AnyOrder::key<3>({t[f[0]], t[f[1]], t[f[2]]}));
  std::sort(faces.begin(), faces.end());
  for (std::size_t i = 2; i < faces.size(); ++i)
    if (faces[i] == faces[i - 2]) return true;
  return false;
}

/// Number of created cells with these vertices.
template <std::size_t N>
int n_created_with(const Cavity& cavity, const std::array<VertexHandle, N>& wanted) {
  int n = 0;
  for (const Tet& t : cavity.created)
    n += std::all_of(wanted.begin(), wanted.end(),
                     [&](VertexHandle v) { return std::find(t.begin(), t.end(), v) != t.end(); })
             ? 1
             : 0;
  return n;
}

/// Appends the faces into which the new vertex cuts one that goes; n_sides created cells have each.
bool append_heirs(const Cavity& cavity, const std::array<VertexHandle, 3>& parent, int n_sides, Heirs& out) {
  constexpr std::size_t kNone = 3;
  if (!cavity.new_vertex || out.size() + 3 > kMostHeirs) return false;
  std::size_t missing = kNone;
  for (std::size_t k = 0; k < 3; ++k) {
    std::array<VertexHandle, 3> child = parent;
    child[k] = Cavity::kNewVertex;
    if (n_created_with(cavity, child) == n_sides) {
      out.push_back({parent, child});
      continue;
    }
    if (missing != kNone) return false;
    missing = k;
  }
  // The child at an edge may be missing only where the new vertex lies on the edge.
  return missing == kNone ||
         n_created_with<2>(cavity, {parent[(missing + 1) % 3], parent[(missing + 2) % 3]}) == 0;
}

}  // namespace

void detail::throw_full(std::size_t n) {
  throw ResourceLimit("an operator has more than " + std::to_string(n) +
                      " cells, or parts of them, in one place; clusters so large have to be left alone");
}

bool find_heirs(const TetMesh& mesh, const Cavity& cavity, Heirs& out) {
  out.clear();
  const Labels& labels = mesh.labels();
  const Locks& locks = mesh.locks();
  if (cavity.surface_is_held || (labels.faces.empty() && locks.faces.empty())) return true;
  const auto first = cavity.removed.begin() + static_cast<std::ptrdiff_t>(cavity.n_removed_first);
  for (const CellHandle* c = cavity.removed.begin(); c != cavity.removed.end(); ++c) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle m = mesh.opposite_halfface(halfface_of(*c, k));
      // A face between the regions once, from the first.
      if (m.is_valid() &&
          (c >= first || std::find(first, cavity.removed.end(), cell_of(m)) == cavity.removed.end()))
        continue;
      const auto face = mesh.halfface_vertices(halfface_of(*c, k));
      const std::size_t at = labels.faces.position(face);
      const bool is_labelled = at != labels.faces.size();
      const bool is_fixed = locks.faces.find(face) != nullptr ||
                            (is_labelled && locks.patches.contains(labels.faces.entries()[at].value));
      if ((!is_labelled && !is_fixed) || n_created_with(cavity, face) > 0) continue;
      if (is_fixed || !append_heirs(cavity, labels.faces.entries()[at].vertices, m.is_valid() ? 2 : 1, out))
        return false;
    }
  }
  return true;
}

void inherit_labels(TetMesh& mesh, std::span<const Heir> heirs, VertexHandle new_vertex) {
  auto& faces = mesh.labels().faces;
  for (std::size_t i = 0; i < heirs.size(); ++i) {
    const auto& parent = heirs[i].parent;
    const int label = *faces.find(parent);
    auto child = heirs[i].child;
    std::replace(child.begin(), child.end(), Cavity::kNewVertex, new_vertex);
    if (i + 1 == heirs.size() || heirs[i + 1].parent != parent) faces.erase_unordered(parent);
    faces.set(child, label);
  }
}

bool makes_twice(const TetMesh& mesh, const Cavity& cavity, Star& scratch, const StarKnowledge& known) {
  if (has_face_of_three_cells(cavity)) return true;
  const auto before = removed_tets(mesh, cavity);
  const SimplexSet<2> old_edges = edges_of(before);
  const SimplexSet<3> old_faces = faces_of(before);
  for (const auto& edge : edges_of(cavity.created)) {
    if (old_edges.has(edge) || edge[1] == Cavity::kNewVertex) continue;
    if (may_exist(mesh, edge, known, scratch)) return true;
  }
  for (const auto& face : faces_of(cavity.created)) {
    if (old_faces.has(face) || face[2] == Cavity::kNewVertex) continue;
    // A face with a new edge is new with it; what is left has three old edges.
    if (!old_edges.has({face[0], face[1]}) || !old_edges.has({face[0], face[2]}) ||
        !old_edges.has({face[1], face[2]}))
      continue;
    if (may_exist(mesh, face, known, scratch)) return true;
  }
  return false;
}

bool admissible(const TetMesh& mesh, const Cavity& cavity, bool check_links, Star& scratch,
                const StarKnowledge& known) {
  if (cavity.moved.is_valid()) return true;
  if (mesh.has_regions()) {
    for (std::size_t i = 0; i < cavity.removed.size(); ++i) {
      const std::size_t first = i < cavity.n_removed_first ? 0 : cavity.n_removed_first;
      if (mesh.region(cavity.removed[i]) != mesh.region(cavity.removed[first])) return false;
    }
  }
  Heirs heirs;
  if (!labels_survive(mesh, cavity, known) || !find_heirs(mesh, cavity, heirs)) return false;
  return !check_links || (is_ball(mesh, cavity) && !makes_twice(mesh, cavity, scratch, known));
}

bool worsens_damage(const TetMesh& mesh, const Cavity& cavity, std::span<const CellHandle> cells,
                    double floor) {
  Damage before, after;
  for (CellHandle c : cells) {
    before.add(mesh, c);
    if (cavity.moved.is_valid()) after.add(mesh, c, cavity.moved, cavity.target);
  }
  const auto at = [&](VertexHandle v) {
    return v == Cavity::kNewVertex ? *cavity.new_vertex : mesh.point(v);
  };
  for (const Tet& t : cavity.created) after.add(at(t[0]), at(t[1]), at(t[2]), at(t[3]));
  return !before.may_become(after, floor);
}

VertexHandle nearest_vertex(const TetMesh& mesh, const Cavity& cavity) {
  VertexHandle nearest;
  double least = std::numeric_limits<double>::infinity();
  for (CellHandle c : cavity.removed) {
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

std::vector<Simplex> created_simplices(const TetMesh& mesh, const Cavity& cavity) {
  std::vector<Simplex> created;
  if (cavity.moved.is_valid()) return created;
  const auto before = removed_tets(mesh, cavity);
  const SimplexSet<2> old_edges = edges_of(before);
  for (const auto& edge : edges_of(cavity.created))
    if (edge[1] != Cavity::kNewVertex && !old_edges.has(edge))
      created.push_back({edge[0], edge[1], VertexHandle()});
  const SimplexSet<3> old_faces = faces_of(before);
  for (const auto& face : faces_of(cavity.created))
    if (face[2] != Cavity::kNewVertex && !old_faces.has(face) && old_edges.has({face[0], face[1]}) &&
        old_edges.has({face[0], face[2]}) && old_edges.has({face[1], face[2]}))
      created.push_back(face);
  return created;
}

}  // namespace hfr
