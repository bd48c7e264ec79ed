// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/FoldedFaces.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "Quality/Metrics.hh"

namespace hfr {
namespace {

constexpr double kVertexNanoseconds = 1'000;

struct Corner {
  VertexHandle vertex;
  HalfFaceHandle face;
};

/// The two other vertices of a face at a vertex.
std::array<VertexHandle, 2> others(const TetMesh& mesh, HalfFaceHandle h, VertexHandle v) {
  const auto f = mesh.halfface_vertices(h);
  return f[0] == v ? std::array{f[1], f[2]} : f[1] == v ? std::array{f[2], f[0]} : std::array{f[0], f[1]};
}

/// True when direction x, in the plane of the directions a and b, is strictly between them.
bool between(Vec3 a, Vec3 b, Vec3 x) {
  const Vec3 n = cross(a, b);
  return dot(n, cross(a, x)) > 0 && dot(n, cross(x, b)) > 0;
}

/// Faces (v, a, b) and (v, a, d): on one another when they lie in a plane and on one side of the common edge.
bool fold_at_edge(Vec3 v, Vec3 a, Vec3 b, Vec3 d) {
  return dot(cross(a - v, b - v), cross(a - v, d - v)) > 0 && orientation(v, a, b, d) == 0;
}

/// Faces (v, a, b) and (v, c, d), seen from v as arcs: whether these meet other than at a common end.
bool fold_at_vertex(Vec3 v, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const int sc = orientation(v, a, b, c);
  const int sd = orientation(v, a, b, d);
  const Vec3 va = a - v, vb = b - v, vc = c - v, vd = d - v;
  if ((sc == 0 && between(va, vb, vc)) || (sd == 0 && between(va, vb, vd))) return true;
  const int sa = orientation(v, c, d, a);
  const int sb = orientation(v, c, d, b);
  if ((sa == 0 && between(vc, vd, va)) || (sb == 0 && between(vc, vd, vb))) return true;
  if (sc * sd >= 0 || sa * sb >= 0) return false;
  // Where the arc from c to d goes through the plane of a and b; the other arc may be on the far side.
  const Vec3 n = cross(va, vb);
  const double hc = dot(n, vc);
  const double hd = dot(n, vd);
  const Vec3 x = (hc > 0 ? hc : -hc) * vd + (hd > 0 ? hd : -hd) * vc;
  return between(va, vb, x);
}

bool fold(const TetMesh& mesh, VertexHandle v, HalfFaceHandle f, HalfFaceHandle g) {
  auto [a, b] = others(mesh, f, v);
  auto [c, d] = others(mesh, g, v);
  const auto p = [&](VertexHandle w) { return mesh.point(w); };
  if ((a == c && b == d) || (a == d && b == c)) return true;
  if (b == c || b == d) std::swap(a, b);
  if (d == a) std::swap(c, d);
  if (a == c) return fold_at_edge(p(v), p(a), p(b), p(d));
  return fold_at_vertex(p(v), p(a), p(b), p(c), p(d));
}

/// In which directions a face lies seen from v, as a box round the arc between those of its other corners.
struct Directions {
  Vec3 low, high;
  std::size_t face;

  Directions(const TetMesh& mesh, VertexHandle v, HalfFaceHandle h, std::size_t i) : face(i) {
    std::array<Vec3, 2> ends;
    std::size_t n = 0;
    for (VertexHandle w : mesh.halfface_vertices(h)) {
      if (w == v || n == 2) continue;
      const Vec3 d = mesh.point(w) - mesh.point(v);
      ends[n++] = (1 / norm(d)) * d;
    }
    const auto is_none = [](Vec3 d) { return !(norm(d) > 0.5); };
    if (is_none(ends[0]) || is_none(ends[1])) {  // a corner in v, or too near to it: anywhere
      low = {-2, -2, -2};
      high = {2, 2, 2};
      return;
    }
    // An arc of angle t leaves the box of its ends by less than the height over its chord, 1 - cos(t/2).
    const double chord = norm(ends[1] - ends[0]);
    const double margin = 1 - std::sqrt(std::max(1 - 0.25 * chord * chord, 0.0)) + 1e-9;
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(ends[0][d], ends[1][d]) - margin;
      high[d] = std::max(ends[0][d], ends[1][d]) + margin;
    }
  }
  bool meets(const Directions& o) const {
    return low.y <= o.high.y && o.low.y <= high.y && low.z <= o.high.z && o.low.z <= high.z;
  }
};

/// Calls visit(i, j) for pairs of faces at v that may fold, until it returns true: for all of few, of many
/// for those that lie in some direction both.
template <class FaceOf, class Visit>
bool any_pair(const TetMesh& mesh, VertexHandle v, std::size_t n, FaceOf&& face_of, Visit&& visit) {
  constexpr std::size_t kFew = 64;
  if (n <= kFew) {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j)
        if (visit(i, j)) return true;
    return false;
  }
  std::vector<Directions> all;
  all.reserve(n);
  for (std::size_t i = 0; i < n; ++i) all.emplace_back(mesh, v, face_of(i), i);
  std::sort(all.begin(), all.end(), [](const Directions& a, const Directions& b) {
    return a.low.x != b.low.x ? a.low.x < b.low.x : a.face < b.face;
  });
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n && all[j].low.x <= all[i].high.x; ++j)
      if (all[i].meets(all[j]) && visit(all[i].face, all[j].face)) return true;
  return false;
}

}  // namespace

std::vector<HalfFaceHandle> folded_faces(const TetMesh& mesh, par::Policy policy,
                                         const std::function<bool(VertexHandle)>& at) {
  const auto boundary = par::compact<Index>(policy, 4 * mesh.n_cells(), [&](std::size_t i) {
    const HalfFaceHandle h(i);
    return !mesh.is_deleted(cell_of(h)) && !mesh.opposite_halfface(h).is_valid();
  });
  // Corners by vertex, of each vertex in the order of the faces.
  std::vector<std::size_t> end_of(mesh.n_vertices() + 1, 0);
  for (Index i : boundary)
    for (VertexHandle v : mesh.halfface_vertices(HalfFaceHandle(i))) ++end_of[v.idx() + 1];
  std::vector<std::size_t> first;  // corner of each vertex that has any
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    if (end_of[v + 1] > 0) first.push_back(end_of[v]);
    end_of[v + 1] += end_of[v];
  }
  first.push_back(3 * boundary.size());
  std::vector<Corner> corners(3 * boundary.size());
  for (Index i : boundary)
    for (VertexHandle v : mesh.halfface_vertices(HalfFaceHandle(i)))
      corners[end_of[v.idx()]++] = {v, HalfFaceHandle(i)};
  const std::size_t n_vertices = first.size() - 1;
  const int n_parts = par::thread_count(policy.for_items_of(kVertexNanoseconds), n_vertices);
  std::vector<std::vector<HalfFaceHandle>> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    auto& mine = found[static_cast<std::size_t>(part)];
    const std::size_t end = par::part_begin(n_vertices, n_parts, part + 1);
    for (std::size_t v = par::part_begin(n_vertices, n_parts, part); v < end; ++v) {
      if (at && !at(corners[first[v]].vertex)) continue;
      const std::span<const Corner> here(&corners[first[v]], first[v + 1] - first[v]);
      any_pair(
          mesh, here[0].vertex, here.size(), [&](std::size_t i) { return here[i].face; },
          [&](std::size_t i, std::size_t j) {
            if (fold(mesh, here[0].vertex, here[i].face, here[j].face)) {
              mine.push_back(here[i].face);
              mine.push_back(here[j].face);
            }
            return false;
          });
    }
  });
  std::vector<HalfFaceHandle> folded;
  for (const auto& part : found) folded.insert(folded.end(), part.begin(), part.end());
  std::sort(folded.begin(), folded.end());
  folded.erase(std::unique(folded.begin(), folded.end()), folded.end());
  return folded;
}

bool is_folded_at(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy) {
  const auto is_folded = [&](std::size_t i) {
    const VertexHandle v = vertices[i];
    std::vector<HalfFaceHandle> faces;
    for (CellHandle c : mesh.vertex_cells(v))
      for (HalfFaceHandle h : mesh.cell_halffaces(c))
        if (mesh.is_boundary(h) && mesh.cell(c).v[static_cast<std::size_t>(corner_of(h))] != v)
          faces.push_back(h);
    return any_pair(
        mesh, v, faces.size(), [&](std::size_t k) { return faces[k]; },
        [&](std::size_t j, std::size_t k) { return fold(mesh, v, faces[j], faces[k]); });
  };
  return !par::compact<std::size_t>(policy.for_items_of(kVertexNanoseconds), vertices.size(), is_folded)
              .empty();
}

}  // namespace hfr
