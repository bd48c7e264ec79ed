// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_REMESH_MESHES_HH
#define HFR_UNITTESTS_REMESH_MESHES_HH

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Remesh/Improve.hh"

namespace hfr::test {

/// In the handler of a refusal that only a build without OpenMesh may have: passes on any other.
inline void expect_build_without_surface() {
#ifdef HFR_HAS_SURFACE
  throw;
#endif
}

/// A cube of 6·n³ cells with a deformed inside; some of its cells are inverted.
inline TetMesh small_cavity(Index n = 10) {
  generate::CavityOptions options;
  options.counts = {n, n, n};
  options.sigma = 0.12;
  options.amplitude = 0.45;
  return built(generate::cavity(options));
}

/// Options for one thread: what is not about threads need not wait for those of others.
inline ImproveOptions serial() {
  ImproveOptions options;
  options.policy = {};
  return options;
}

/// A jittered box of two regions with an uneven interface. Boundary and interface faces, the edges between
/// patches, some edges inside, and some vertices are labelled; one inner vertex is fixed.
inline TetMesh labelled_box(Index n, double jitter, std::uint64_t seed) {
  generate::Arrays arrays = generate::jittered_box({n, n, n}, jitter, seed);
  arrays.regions = generate::two_region_box({n, n, n}).regions;
  const generate::Arrays regular = generate::box({n, n, n});
  for (std::size_t i = 0; i < arrays.points.size(); ++i)  // so that no cell is inverted for good
    if (regular.points[i].x == 0.5)
      arrays.points[i] = regular.points[i] + 0.1 * (arrays.points[i] - regular.points[i]);
  TetMesh mesh = built(arrays);
  Labels& labels = mesh.labels();
  for (HalfFaceHandle h : mesh.halffaces()) {
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    const auto f = mesh.halfface_vertices(h);
    if (!m.is_valid()) {
      int patch = 0;
      for (int i = 0; i < 3; ++i)
        for (const double side : {0.0, 1.0})
          if (mesh.point(f[0])[i] == side && mesh.point(f[1])[i] == side && mesh.point(f[2])[i] == side)
            patch = 1 + 2 * i + static_cast<int>(side);
      labels.faces.set(f, patch);
    } else if (h < m && mesh.region(cell_of(h)) != mesh.region(cell_of(m))) {
      labels.faces.set(f, 7);
    }
  }
  labels.vertices.assign(mesh.n_vertices(), 0);
  std::size_t at = 0;
  for (EdgeHandle e : mesh.edges())
    if (!mesh.is_boundary(e) && ++at % 97 == 0) labels.edges.set(mesh.edge_vertices(e), static_cast<int>(at));
  for (VertexHandle v : mesh.vertices())
    if (v.idx() % 19 == 3) labels.vertices[v.idx()] = static_cast<int>(1 + v.idx());
  mesh.set_fixed(V((n / 2 * (n + 1) + n / 2) * (n + 1) + 1));
  return mesh;
}

inline Place place_of(const TetMesh& mesh, VertexHandle v) {
  const Vec3 p = mesh.point(v);
  return {p.x, p.y, p.z};
}

/// Labels by the places of the vertices: handles may change.
template <std::size_t N>
std::set<std::pair<std::set<Place>, int>> places_of(const TetMesh& mesh, const TupleMap<N, int>& labels) {
  std::set<std::pair<std::set<Place>, int>> all;
  for (const auto& entry : labels.entries()) {
    std::set<Place> corners;
    for (VertexHandle v : entry.vertices) corners.insert(place_of(mesh, v));
    all.emplace(corners, entry.value);
  }
  return all;
}

inline std::multiset<int> vertex_labels(const TetMesh& mesh) {
  std::multiset<int> all;
  for (VertexHandle v : mesh.vertices())
    if (mesh.labels().vertex(v) != 0) all.insert(mesh.labels().vertex(v));
  return all;
}

/// Places of the vertices that must not move.
inline std::set<Place> frozen_places(const TetMesh& mesh) {
  const auto frozen = frozen_vertices(mesh);
  std::set<Place> all;
  for (VertexHandle v : mesh.vertices())
    if (frozen[v.idx()]) all.insert(place_of(mesh, v));
  return all;
}

inline std::map<int, double> region_volumes(const TetMesh& mesh) {
  std::map<int, double> sums;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    const Vec3 a = mesh.point(v[0]);
    sums[mesh.region(c)] += dot(mesh.point(v[1]) - a, cross(mesh.point(v[2]) - a, mesh.point(v[3]) - a)) / 6;
  }
  return sums;
}

/// Handles run without gaps and nothing waits to be collected.
inline void expect_dense(const TetMesh& mesh) {
  EXPECT_EQ(mesh.n_logical_cells(), mesh.n_cells());
  EXPECT_EQ(mesh.n_logical_vertices(), mesh.n_vertices());
  EXPECT_TRUE(mesh.free_cells().empty());
  EXPECT_TRUE(unused_vertices(mesh).empty());
}

}  // namespace hfr::test

#endif
