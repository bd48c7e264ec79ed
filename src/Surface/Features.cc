// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/Features.hh"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

namespace hfr::surface {
namespace {

/// Of the diagonal: vertices no further from a plane or line lie in it. What they are moved onto it by, times
/// the area, is what the volume may change.
constexpr double kCoplanar = 1e-13;

double diagonal(const TetMesh& mesh, const Arrays& arrays) {
  if (arrays.faces.empty()) return 0;
  Vec3 low = mesh.point(arrays.faces[0][0]);
  Vec3 high = low;
  for (const auto& f : arrays.faces) {
    for (VertexHandle v : f) {
      const Vec3 p = mesh.point(v);
      for (int d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], p[d]);
        high[d] = std::max(high[d], p[d]);
      }
    }
  }
  return norm(high - low);
}

std::vector<Edge> find_edges(const Arrays& arrays) {
  struct Use {
    VertexHandle a, b;
    std::uint32_t f;
    std::uint8_t k;
    bool forth;  // the face has the edge from a to b
  };
  std::vector<Use> uses;
  uses.reserve(3 * arrays.faces.size());
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      const VertexHandle a = arrays.faces[i][k];
      const VertexHandle b = arrays.faces[i][(k + 1U) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(i), k, a < b});
    }
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& x, const Use& y) { return std::tie(x.a, x.b, x.f) < std::tie(y.a, y.b, y.f); });
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    while (end < uses.size() && uses[end].a == uses[i].a && uses[end].b == uses[i].b) ++end;
    Edge edge{uses[i].a, uses[i].b, {uses[i].f, uses[end - 1].f}, {uses[i].k, uses[end - 1].k}};
    edge.manifold = end - i == 2 && uses[i].forth != uses[i + 1].forth;
    edges.push_back(edge);
    i = end;
  }
  return edges;
}

/// Planar facets: grown from the largest face that is in none yet, over edges where the surface does not turn
/// back, as long as all corners lie in the plane.
std::vector<std::uint32_t> find_facets(const TetMesh& mesh, const Arrays& arrays,
                                       const std::vector<Edge>& edges, double tolerance,
                                       std::vector<Freedom>& planes) {
  constexpr std::uint32_t kNone = ~0U;
  const std::size_t n = arrays.faces.size();
  std::vector<Vec3> normal(n);
  std::vector<std::uint32_t> order(n);
  std::vector<std::array<std::uint32_t, 3>> across(n, {kNone, kNone, kNone});
  for (std::size_t i = 0; i < n; ++i) normal[i] = scaled_normal(corners(mesh, arrays.faces[i]));
  for (const Edge& e : edges) {
    if (!e.manifold) continue;
    across[e.f[0]][e.k[0]] = e.f[1];
    across[e.f[1]][e.k[1]] = e.f[0];
  }
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t x, std::uint32_t y) { return norm2(normal[x]) > norm2(normal[y]); });
  std::vector<std::uint32_t> facet(n, kNone);
  std::vector<std::uint32_t> front;
  for (std::uint32_t seed : order) {
    if (facet[seed] != kNone) continue;
    const auto number = static_cast<std::uint32_t>(planes.size());
    const Freedom plane{SurfaceKind::kFacet, mesh.point(arrays.faces[seed][0]), unit(normal[seed])};
    planes.push_back(plane);
    facet[seed] = number;
    front.assign(1, seed);
    while (!front.empty()) {
      const std::uint32_t f = front.back();
      front.pop_back();
      for (std::uint32_t g : across[f]) {
        if (g == kNone || facet[g] != kNone || !(dot(normal[g], plane.axis) > 0)) continue;
        const bool flat = std::all_of(arrays.faces[g].begin(), arrays.faces[g].end(), [&](VertexHandle v) {
          return std::abs(dot(mesh.point(v) - plane.anchor, plane.axis)) <= tolerance;
        });
        if (!flat) continue;
        facet[g] = number;
        front.push_back(g);
      }
    }
  }
  return facet;
}

/// Edges that only turn, in connected sets that fit into a box of a few times the length that is taken for
/// noise, are noise of the input and no features.
void drop_small(const TetMesh& mesh, std::vector<Edge>& edges, const std::vector<std::uint8_t>& only_turns,
                double detail) {
  constexpr double kSmall = 3;
  struct Set {
    Vec3 low, high;
    bool keeps = false;  // has an edge that is one for another reason
  };
  std::vector<Index> parent(mesh.n_vertices());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const Edge& e : edges) {
    if (!e.feature) continue;
    const Index a = root(e.a.idx());
    const Index b = root(e.b.idx());
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::map<Index, Set> sets;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    if (!e.feature) continue;
    const auto [at, is_new] = sets.try_emplace(root(e.a.idx()));
    Set& set = at->second;
    if (is_new) set.low = set.high = mesh.point(e.a);
    for (VertexHandle v : {e.a, e.b}) {
      const Vec3 p = mesh.point(v);
      for (int d = 0; d < 3; ++d) {
        set.low[d] = std::min(set.low[d], p[d]);
        set.high[d] = std::max(set.high[d], p[d]);
      }
    }
    set.keeps = set.keeps || !only_turns[i];
  }
  for (Edge& e : edges) {
    if (!e.feature) continue;
    const Set& set = sets.at(root(e.a.idx()));
    if (!set.keeps && norm(set.high - set.low) < kSmall * detail) e.feature = false;
  }
}

struct Incidence {
  std::uint32_t n_features = 0;
  std::array<VertexHandle, 2> along;  // other ends of the first two
  std::uint32_t face = 0;             // some face of the vertex
  bool locked = false;
};

Freedom freedom_of(const TetMesh& mesh, VertexHandle v, const Incidence& at, const SurfaceOptions& options,
                   double tolerance, Freedom plane) {
  const Vec3 p = mesh.point(v);
  const Freedom fixed{SurfaceKind::kFixed, p, {}};
  if (at.locked || (at.n_features != 0 && at.n_features != 2)) return fixed;
  if (at.n_features == 0) return plane;
  const Vec3 back = mesh.point(at.along[0]);
  const Vec3 ahead = mesh.point(at.along[1]);
  const Vec3 axis = unit(ahead - back);
  if (options.mode == SurfaceMode::kFlat) {
    const Vec3 r = p - back;
    const bool straight = norm(r - dot(r, axis) * axis) <= tolerance && dot(p - back, ahead - p) > 0;
    return straight ? Freedom{SurfaceKind::kCurve, back, axis} : fixed;
  }
  const double cosine = dot(unit(p - back), unit(ahead - p));
  return cosine >= std::cos(options.feature_angle * (std::numbers::pi / 180.0))
             ? Freedom{SurfaceKind::kCurve, p, axis}
             : fixed;
}

}  // namespace

Arrays gather(const TetMesh& mesh, const SurfaceOptions& options, par::Policy policy) {
  const auto halffaces = par::compact<Index>(policy, 4 * mesh.n_cells(), [&](std::size_t i) {
    const HalfFaceHandle h(i);
    if (mesh.is_deleted(cell_of(h))) return false;
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    return !m.is_valid() || mesh.region(cell_of(h)) < mesh.region(cell_of(m));
  });
  std::set<std::array<VertexHandle, 3>> fixed;
  for (auto f : options.fixed_faces) {
    std::sort(f.begin(), f.end());
    fixed.insert(f);
  }
  Arrays arrays;
  const auto& labels = mesh.labels().faces;
  for (Index i : halffaces) {
    const HalfFaceHandle h(i);
    const auto f = mesh.halfface_vertices(h);
    const std::size_t entry = labels.position(f);
    const int* label = entry < labels.size() ? &labels.entries()[entry].value : nullptr;
    arrays.faces.push_back({f[0], f[2], f[1]});
    arrays.halffaces.push_back(h);
    arrays.patch.push_back(label ? *label : 0);
    const bool inward = label && CyclicOrder::key(labels.entries()[entry].vertices) == CyclicOrder::key(f);
    arrays.inward.push_back(inward ? 1 : 0);
    auto key = f;
    std::sort(key.begin(), key.end());
    const auto& patches = options.fixed_patches;
    const bool locked = !mesh.is_boundary(h) || fixed.contains(key) ||
                        (label && std::find(patches.begin(), patches.end(), *label) != patches.end());
    arrays.locked.push_back(locked ? 1 : 0);
  }
  return arrays;
}

double mean_edge(const TetMesh& mesh, const Arrays& arrays) {
  double sum = 0;
  for (const auto& f : arrays.faces)
    for (std::size_t k = 0; k < 3; ++k) sum += norm(mesh.point(f[(k + 1) % 3]) - mesh.point(f[k]));
  return arrays.faces.empty() ? 0 : sum / (3.0 * static_cast<double>(arrays.faces.size()));
}

Features find_features(const TetMesh& mesh, const Arrays& arrays, const SurfaceOptions& options,
                       double detail) {
  const bool flat = options.mode != SurfaceMode::kFree;
  const double tolerance = kCoplanar * diagonal(mesh, arrays);
  const double cosine = std::cos(options.feature_angle * (std::numbers::pi / 180.0));
  Features found;
  found.edges = find_edges(arrays);
  std::vector<Freedom> planes;
  if (flat) found.facet = find_facets(mesh, arrays, found.edges, tolerance, planes);

  std::vector<Incidence> at(mesh.n_vertices());
  std::vector<std::uint8_t> on_surface(mesh.n_vertices(), 0);
  std::set<std::array<VertexHandle, 2>> fixed;
  for (auto e : options.fixed_edges) fixed.insert({std::min(e[0], e[1]), std::max(e[0], e[1])});
  std::vector<Vec3> normal;
  for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
    normal.push_back(unit(scaled_normal(corners(mesh, arrays.faces[i]))));
    const bool interface = !mesh.is_boundary(arrays.halffaces[i]);
    for (VertexHandle v : arrays.faces[i]) {
      on_surface[v.idx()] = 1;
      at[v.idx()].face = static_cast<std::uint32_t>(i);
      // An interface keeps its shape in both regions when its vertices slide within planes; nothing more yet.
      if (arrays.locked[i] && !(interface && flat)) at[v.idx()].locked = true;
    }
  }
  std::vector<std::uint8_t> only_turns;
  for (Edge& e : found.edges) {
    const bool turns = flat ? e.manifold && found.facet[e.f[0]] != found.facet[e.f[1]]
                            : e.manifold && dot(normal[e.f[0]], normal[e.f[1]]) < cosine;
    e.locked = mesh.is_labelled_edge(e.a, e.b) || fixed.contains({e.a, e.b});
    const bool other = !e.manifold || arrays.patch[e.f[0]] != arrays.patch[e.f[1]] || e.locked;
    e.feature = turns || other;
    only_turns.push_back(other ? 0 : 1);
  }
  if (!flat) drop_small(mesh, found.edges, only_turns, detail);
  for (const Edge& e : found.edges) {
    if (!e.feature) continue;
    const std::array<VertexHandle, 2> ends = {e.a, e.b};
    for (std::size_t i = 0; i < 2; ++i) {
      Incidence& here = at[ends[i].idx()];
      if (here.n_features < 2) here.along[here.n_features] = ends[1 - i];
      ++here.n_features;
      here.locked = here.locked || e.locked;
    }
  }
  // Labelled faces inside a region are no part of the surface; they hold what they meet.
  for (const auto& entry : mesh.labels().faces.entries()) {
    const bool known = std::all_of(entry.vertices.begin(), entry.vertices.end(),
                                   [&](VertexHandle v) { return on_surface[v.idx()] != 0; });
    if (known) {
      const HalfFaceHandle h = mesh.find_halfface(entry.vertices);
      if (!h.is_valid() || mesh.is_boundary(h) ||
          mesh.region(cell_of(h)) != mesh.region(cell_of(mesh.opposite_halfface(h))))
        continue;
    }
    for (VertexHandle v : entry.vertices) at[v.idx()].locked = true;
  }
  for (const auto& entry : mesh.labels().edges.entries())  // inside, too
    for (VertexHandle v : entry.vertices) at[v.idx()].locked = true;
  for (VertexHandle v : options.fixed_vertices)
    if (v.idx() < at.size()) at[v.idx()].locked = true;
  found.freedom.resize(mesh.n_vertices());
  for (std::size_t i = 0; i < found.freedom.size(); ++i) {
    if (!on_surface[i]) continue;
    const VertexHandle v(i);
    at[i].locked = at[i].locked || mesh.is_fixed(v);
    const std::uint32_t f = at[i].face;
    const Freedom plane =
        flat ? planes[found.facet[f]] : Freedom{SurfaceKind::kFacet, mesh.point(v), normal[f]};
    found.freedom[i] = freedom_of(mesh, v, at[i], options, tolerance, plane);
  }
  return found;
}

}  // namespace hfr::surface
