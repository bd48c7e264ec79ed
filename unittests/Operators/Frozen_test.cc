// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "Operators/Clusters.hh"
#include "Operators/Operator.hh"

namespace hfr::test {
namespace {

std::set<std::size_t> frozen_set(const TetMesh& mesh) {
  const auto frozen = frozen_vertices(mesh);
  std::set<std::size_t> set;
  for (std::size_t i = 0; i < frozen.size(); ++i)
    if (frozen[i]) set.insert(i);
  return set;
}

bool on_surface(const TetMesh& mesh, VertexHandle v) {
  const Vec3 p = mesh.point(v);
  for (int i = 0; i < 3; ++i)
    if (p[i] == 0 || p[i] == 1) return true;
  return false;
}

TEST(FrozenVertices, BoundaryIsFrozenAndNothingElse) {
  const TetMesh mesh = jittered(4, 0.3, 1);
  const auto frozen = frozen_vertices(mesh);
  for (VertexHandle v : mesh.vertices()) EXPECT_EQ(frozen[v.idx()] != 0, on_surface(mesh, v));
  for (const int threads : {2, 3}) EXPECT_EQ(frozen_vertices(mesh, {threads, 1}), frozen);
}

TEST(FrozenVertices, InterfaceBetweenRegionsIsFrozen) {
  const TetMesh mesh = built(generate::two_region_box({4, 4, 4}));
  const auto frozen = frozen_vertices(mesh);
  int interface = 0;
  for (VertexHandle v : mesh.vertices()) {
    const bool between = mesh.point(v).x == 0.5;
    EXPECT_EQ(frozen[v.idx()] != 0, on_surface(mesh, v) || between);
    interface += between && !on_surface(mesh, v) ? 1 : 0;
  }
  EXPECT_EQ(interface, 9);
}

TEST(FrozenVertices, FixedVertexIsFrozen) {
  TetMesh mesh = octahedron();
  EXPECT_EQ(frozen_set(mesh), (std::set<std::size_t>{1, 2, 3, 4, 5, 6}));
  mesh.set_fixed(V(0));
  EXPECT_TRUE(frozen_set(mesh).contains(0));
}

TEST(FrozenVertices, CornersOfFixedInnerFacesAndEdgesAreFrozen) {
  const TetMesh mesh = jittered(4, 0.0, 1);
  const VertexHandle middle = V((2 * 5 + 2) * 5 + 2);
  const HalfFaceHandle h =
      mesh.vertex_opposite_halfface(mesh.incident_cell(middle), mesh.cell(mesh.incident_cell(middle)).v[0]);
  TetMesh with_face = mesh;
  with_face.set_fixed(mesh.face_handle(h));
  EXPECT_TRUE(with_face.is_constrained(h));
  EXPECT_FALSE(mesh.is_constrained(h));
  for (VertexHandle v : mesh.halfface_vertices(h)) EXPECT_TRUE(frozen_set(with_face).contains(v.idx()));
  TetMesh with_edge = mesh;
  const EdgeHandle e = mesh.edge_in_cell(mesh.incident_cell(middle), 0);
  with_edge.set_fixed(e);
  for (VertexHandle v : mesh.edge_vertices(e)) EXPECT_TRUE(frozen_set(with_edge).contains(v.idx()));
}

TEST(FrozenVertices, CornersOfLabelledInnerFacesAndEdgesAreFrozen) {
  TetMesh mesh = jittered(4, 0.0, 1);
  const VertexHandle middle = V((2 * 5 + 2) * 5 + 2);
  ASSERT_FALSE(frozen_set(mesh).contains(middle.idx()));
  for (HalfFaceHandle h : all_faces(mesh)) {
    const auto f = mesh.halfface_vertices(h);
    if (f[0] != middle) continue;
    TetMesh labelled = mesh;
    labelled.labels().faces.set(f, 4);
    for (VertexHandle v : f) EXPECT_TRUE(frozen_set(labelled).contains(v.idx()));
    break;
  }
  for (EdgeHandle e : mesh.edges()) {
    const auto ends = mesh.edge_vertices(e);
    if (ends[0] != middle) continue;
    TetMesh labelled = mesh;
    labelled.labels().edges.set(ends, 4);
    EXPECT_TRUE(frozen_set(labelled).contains(middle.idx()));
    break;
  }
  mesh.labels().vertices.assign(mesh.n_vertices(), 0);
  mesh.labels().vertices[middle.idx()] = 1;
  EXPECT_FALSE(frozen_set(mesh).contains(middle.idx())) << "a labelled vertex may move";
}

TEST(FrozenVertices, VertexInTheMiddleOfTwoSeparateStarsIsFrozen) {
  // Two tetrahedra, each cut into four round the same vertex 0: no boundary face has it.
  std::vector<Vec3> points = {{0, 0, 0}};
  std::vector<Corners> cells;
  for (const double side : {1.0, -1.0}) {
    const Index first = static_cast<Index>(points.size());
    for (const Vec3 p : {Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}})
      points.push_back(side * p);
    for (Index k = 0; k < 4; ++k) {
      Corners c = {first, first + 1, first + 2, first + 3};
      c[k] = 0;
      cells.push_back(c);
    }
  }
  const TetMesh mesh = build(points, cells);
  for (HalfFaceHandle h : mesh.boundary_halffaces())
    for (VertexHandle v : mesh.halfface_vertices(h)) ASSERT_NE(v, V(0));
  EXPECT_TRUE(frozen_set(mesh).contains(0));
}

TEST(FrozenVertices, VertexOfTooManyCellsIsFrozen) {
  for (const Index n : {100U, 150U}) {  // 200 and 300 cells
    std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<Corners> cells;
    for (Index i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      points.push_back({std::cos(angle), std::sin(angle), 0});
      cells.push_back({0, 3 + i, 3 + (i + 1) % n, 1});
      cells.push_back({0, 3 + (i + 1) % n, 3 + i, 2});
    }
    EXPECT_EQ(frozen_set(build(points, cells)).contains(0), n == 150);
  }
}

}  // namespace
}  // namespace hfr::test
