// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_OPERATORS_CLUSTERS_HH
#define HFR_UNITTESTS_OPERATORS_CLUSTERS_HH

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "HalfFace/Generate.hh"
#include "HalfFace/Meshes.hh"
#include "HalfFace/TetMesh.hh"
#include "Operators/Operator.hh"
#include "Operators/Replace.hh"
#include "Quality/Metrics.hh"

namespace hfr::test {

__extension__ typedef __int128 Int128;
using Corners = std::array<Index, 4>;
using Engine = std::mt19937_64;

inline double uniform(Engine& engine, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(engine);
}
inline Vec3 random_point(Engine& engine, double low, double high) {
  const double x = uniform(engine, low, high);
  const double y = uniform(engine, low, high);
  return {x, y, uniform(engine, low, high)};
}
inline VertexHandle V(std::size_t i) { return VertexHandle(i); }
inline CellHandle C(std::size_t i) { return CellHandle(i); }

// --- meshes ---

/// Edge from vertex 0 (below) to vertex 1 (above), and its ring 2 … n+1; cell i is (0, 1, i+2, i+3).
inline TetMesh spindle(const std::vector<Vec3>& points) {
  const Index n = static_cast<Index>(points.size() - 2);
  std::vector<Corners> cells;
  for (Index i = 0; i < n; ++i) cells.push_back({0, 1, i + 2, (i + 1) % n + 2});
  return build(points, cells);
}

/// A spindle that bulges and sags at random. With `wild` > 0 its ring vertices leave their sectors, so that
/// cells invert.
inline TetMesh random_spindle(std::size_t n, Engine& engine, double wild = 0) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  for (std::size_t i = 0; i < n; ++i) {
    const double angle =
        2 * std::numbers::pi * (static_cast<double>(i) + uniform(engine, -0.4, 0.4)) / static_cast<double>(n);
    const double radius = uniform(engine, 0.4, 1.6);
    points.push_back({radius * std::cos(angle), radius * std::sin(angle), uniform(engine, -0.7, 0.7)});
  }
  TetMesh mesh = spindle(points);  // before any cell inverts: build() turns a mesh that is mostly inverted
  for (std::size_t i = 2; i < points.size(); ++i)
    mesh.set_point(V(i), mesh.point(V(i)) + wild * random_point(engine, -1, 1));
  return mesh;
}

/// Two cells on the regular triangle (0, 1, 2), apexes 3 above and 4 below.
inline TetMesh bipyramid(double height) {
  const double s = std::sqrt(0.75);
  return build({{1, 0, 0}, {-0.5, s, 0}, {-0.5, -s, 0}, {0, 0, height}, {0, 0, -height}},
               std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 1, 4}});
}

/// Vertex 0 in the middle of an octahedron: x = ±1 are 1, 2; y 3, 4; z 5, 6. The middle stands at `centre`.
inline TetMesh octahedron(Vec3 centre = {}) {
  std::vector<Corners> cells;
  for (Index x = 1; x <= 2; ++x)
    for (Index y = 3; y <= 4; ++y)
      for (Index z = 5; z <= 6; ++z)
        cells.push_back((x + y + z) % 2 == 1 ? Corners{0, x, y, z} : Corners{0, y, x, z});
  return build({centre, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, cells);
}

inline TetMesh jittered(Index n, double jitter, std::uint64_t seed) {
  return built(generate::jittered_box({n, n, n}, jitter, seed));
}

/// The jittered box on integer coordinates 0 … 2^20, whose volumes are exact.
inline TetMesh integer_box(Index n, double jitter, std::uint64_t seed) {
  TetMesh mesh = jittered(n, jitter, seed);
  const auto whole = [](double x) { return std::round(x * 1048576.0); };
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    const Vec3 p = mesh.point(V(i));
    mesh.set_point(V(i), {whole(p.x), whole(p.y), whole(p.z)});
  }
  return mesh;
}

// --- measures ---

/// Six times the signed volume of a cell on integer coordinates.
inline Int128 exact_volume6(const TetMesh& mesh, const Tet& t) {
  std::array<std::array<Int128, 3>, 3> e;
  for (std::size_t k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i)
      e[k][static_cast<std::size_t>(i)] =
          static_cast<Int128>(mesh.point(t[k + 1])[i]) - static_cast<Int128>(mesh.point(t[0])[i]);
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
         e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}
inline Int128 exact_volume6(const TetMesh& mesh) {
  Int128 sum = 0;
  for (CellHandle c : mesh.cells()) sum += exact_volume6(mesh, mesh.cell(c).v);
  return sum;
}

inline double volume(const TetMesh& mesh) {
  double sum = 0;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    const Vec3 a = mesh.point(v[0]);
    sum += dot(mesh.point(v[1]) - a, cross(mesh.point(v[2]) - a, mesh.point(v[3]) - a)) / 6;
  }
  return sum;
}

template <class Metric>
double quality_of(const TetMesh& mesh, const Tet& t, const Metric& metric) {
  return metric(mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2]), mesh.point(t[3]));
}

/// Decision value per cell slot; +infinity where there is no cell.
template <class Metric>
std::vector<double> qualities(const TetMesh& mesh, const Metric& metric) {
  std::vector<double> quality(mesh.n_cells(), std::numeric_limits<double>::infinity());
  for (CellHandle c : mesh.cells()) quality[c.idx()] = quality_of(mesh, mesh.cell(c).v, metric);
  return quality;
}

template <class Metric>
double worst_quality(const TetMesh& mesh, const Metric& metric) {
  const auto quality = qualities(mesh, metric);
  return *std::min_element(quality.begin(), quality.end());
}

template <class Metric, class Tets>
double worst_of_tets(const TetMesh& mesh, const Tets& tets, const Metric& metric) {
  double worst = std::numeric_limits<double>::infinity();
  for (const Tet& t : tets) worst = std::min(worst, quality_of(mesh, t, metric));
  return worst;
}

/// What a plan does to the mesh, after a check that it is what the plan claims.
template <class Op>
Cavity cavity_of(const Op& op, const TetMesh& mesh, const typename Op::Plan& plan) {
  Cavity cavity;
  op.cavity(mesh, plan, cavity);
  Scope scope;
  op.scope(mesh, plan.seed, scope);
  EXPECT_TRUE(std::equal(scope.begin(), scope.end(), cavity.removed.begin(), cavity.removed.end()))
      << "removed cells are the scope, in its order";
  EXPECT_EQ(plan.n_removed, cavity.removed.size());
  EXPECT_EQ(plan.n_created, cavity.created.size());
  EXPECT_EQ(plan.n_removed_first, cavity.n_removed_first);
  EXPECT_EQ(plan.n_created_first, cavity.n_created_first);
  EXPECT_EQ(plan.adds_vertex, cavity.new_vertex.has_value());
  EXPECT_EQ(plan.removes_vertex, cavity.removed_vertex.is_valid());
  double old_worst = std::numeric_limits<double>::infinity();
  for (CellHandle c : cavity.removed) old_worst = std::min(old_worst, op.quality[c.idx()]);
  EXPECT_EQ(plan.old_worst, old_worst);
  const auto at = [&](VertexHandle v) {
    return v == Cavity::kNewVertex ? *cavity.new_vertex : mesh.point(v);
  };
  double new_worst = std::numeric_limits<double>::infinity();
  for (const Tet& t : cavity.created)
    new_worst = std::min(new_worst, op.metric(at(t[0]), at(t[1]), at(t[2]), at(t[3])));
  EXPECT_EQ(plan.new_worst, new_worst) << "the plan is not what it claims";
  EXPECT_GT(plan.new_worst, plan.old_worst);
  return cavity;
}

inline std::size_t n_inverted(const TetMesh& mesh) {
  const auto quality = qualities(mesh, VolumeLength{});
  return static_cast<std::size_t>(
      std::count_if(quality.begin(), quality.end(), [](double q) { return q < 0; }));
}

// --- what must stay ---

using Place = std::array<double, 3>;

/// Boundary triangles by the bits of their corners.
inline std::set<std::array<Place, 3>> boundary_of(const TetMesh& mesh) {
  std::set<std::array<Place, 3>> faces;
  for (CellHandle c : mesh.cells()) {
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      if (mesh.opposite_halfface(h).is_valid()) continue;
      std::array<Place, 3> face;
      const auto f = mesh.halfface_vertices(h);
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 p = mesh.point(f[i]);
        face[i] = {p.x, p.y, p.z};
      }
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      faces.insert(face);
    }
  }
  return faces;
}

inline Tet sorted(Tet t) {
  std::sort(t.begin(), t.end());
  return t;
}

/// Cells as sets of vertices.
inline std::set<Tet> tets_of(const TetMesh& mesh) {
  std::set<Tet> tets;
  for (CellHandle c : mesh.cells()) tets.insert(sorted(mesh.cell(c).v));
  return tets;
}

/// True when cells, mates, incident cells, points and the free list are the same to the last bit.
inline bool identical(const TetMesh& a, const TetMesh& b) {
  if (a.n_cells() != b.n_cells() || a.n_vertices() != b.n_vertices()) return false;
  for (std::size_t i = 0; i < a.n_cells(); ++i)
    if (a.cell(C(i)).v != b.cell(C(i)).v || a.cell(C(i)).mate != b.cell(C(i)).mate) return false;
  for (std::size_t i = 0; i < a.n_vertices(); ++i)
    if (!(a.point(V(i)) == b.point(V(i))) || a.incident_cell(V(i)) != b.incident_cell(V(i)) ||
        a.is_deleted(V(i)) != b.is_deleted(V(i)))
      return false;
  return a.free_cells() == b.free_cells();
}

// --- seeds by brute force ---

inline std::vector<EdgeHandle> all_edges(const TetMesh& mesh) {
  const auto range = mesh.edges();
  return {range.begin(), range.end()};
}
inline std::vector<HalfFaceHandle> all_faces(const TetMesh& mesh) {
  std::vector<HalfFaceHandle> faces;
  for (FaceHandle f : mesh.faces()) faces.push_back(HalfFaceHandle(f.idx()));
  return faces;
}
inline std::vector<VertexHandle> all_vertices(const TetMesh& mesh) {
  const auto range = mesh.vertices();
  return {range.begin(), range.end()};
}

/// Local number of the edge (a, b) in some cell, as a handle 6·cell + local edge.
inline EdgeHandle edge_between(const TetMesh& mesh, VertexHandle a, VertexHandle b) {
  return mesh.find_edge(a, b);
}

inline std::size_t ring_size(const TetMesh& mesh, VertexHandle a, VertexHandle b) {
  std::size_t n = 0;
  for (CellHandle c : mesh.cells()) n += mesh.cell(c).has(a) && mesh.cell(c).has(b) ? 1 : 0;
  return n;
}

/// Corners of a triangle of a ring, counted round it.
using RingTriangle = std::array<std::size_t, 3>;

/// All triangulations of the polygon lo … hi (its side lo-hi included).
inline std::vector<std::vector<RingTriangle>> triangulations(std::size_t lo, std::size_t hi) {
  if (hi - lo < 2) return {{}};
  std::vector<std::vector<RingTriangle>> all;
  for (std::size_t k = lo + 1; k < hi; ++k)
    for (const auto& left : triangulations(lo, k))
      for (const auto& right : triangulations(k, hi)) {
        std::vector<RingTriangle> one = left;
        one.insert(one.end(), right.begin(), right.end());
        one.push_back({lo, k, hi});
        all.push_back(one);
      }
  return all;
}

/// The cells that the triangles of a spindle's ring make with its axis' ends.
inline std::vector<Tet> cells_on(const std::vector<RingTriangle>& triangulation) {
  std::vector<Tet> tets;
  for (const RingTriangle& t : triangulation) {
    tets.push_back({V(t[0] + 2), V(t[1] + 2), V(t[2] + 2), V(1)});
    tets.push_back({V(t[1] + 2), V(t[0] + 2), V(t[2] + 2), V(0)});
  }
  return tets;
}

/// The outer triangles of a cluster as their cells see them, found by comparing vertices only.
inline std::vector<std::array<VertexHandle, 3>> outer_faces(const TetMesh& mesh,
                                                            const std::vector<CellHandle>& cells) {
  std::vector<std::array<VertexHandle, 3>> all;
  for (CellHandle c : cells)
    for (int k = 0; k < 4; ++k) all.push_back(mesh.halfface_vertices(halfface_of(c, k)));
  const auto key = [](std::array<VertexHandle, 3> f) {
    std::sort(f.begin(), f.end());
    return f;
  };
  std::vector<std::array<VertexHandle, 3>> outer;
  for (const auto& f : all)
    if (std::count_if(all.begin(), all.end(), [&](const auto& g) { return key(g) == key(f); }) == 1)
      outer.push_back(f);
  return outer;
}

/// Largest worst value over all ways to join one of the cluster's surface vertices to its outer triangles.
template <class Metric>
double best_star(const TetMesh& mesh, const std::vector<CellHandle>& cells, const Metric& metric,
                 VertexHandle without = {}) {
  const auto faces = outer_faces(mesh, cells);
  std::set<VertexHandle> apexes;
  for (const auto& f : faces) apexes.insert(f.begin(), f.end());
  double best = -std::numeric_limits<double>::infinity();
  for (VertexHandle apex : apexes) {
    if (apex == without) continue;
    std::vector<Tet> tets;
    for (const auto& f : faces)
      if (std::find(f.begin(), f.end(), apex) == f.end()) tets.push_back({f[0], f[1], f[2], apex});
    if (!tets.empty()) best = std::max(best, worst_of_tets(mesh, tets, metric));
  }
  return best;
}

}  // namespace hfr::test

#endif
