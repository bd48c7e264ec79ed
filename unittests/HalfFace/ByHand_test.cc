// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "HalfFace/Check.hh"
#include "HalfFace/Writer.hh"
#include "Meshes.hh"
#include "Oracle.hh"

namespace hfr {
namespace {

using V = VertexHandle;
using test::Corners;

CheckOptions structure() { return {.last = Rule::kDuplicateEdge}; }

std::string message_of(auto&& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// 0 … n-1, shuffled.
std::vector<std::size_t> shuffled(std::size_t n, std::uint64_t seed) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = n; i > 1; --i)
    std::swap(order[i - 1],
              order[static_cast<std::size_t>(generate::random_unit(seed, i) * static_cast<double>(i))]);
  return order;
}

TEST(AddCell, BoxCellByCellEqualsTheBuiltOne) {
  const generate::Arrays box = generate::box({2, 2, 2});
  TetMesh mesh;
  for (Vec3 p : box.points) mesh.add_vertex(p);
  for (std::size_t i : shuffled(box.cells.size(), 7)) {
    const Corners& c = box.cells[i];
    mesh.add_cell(V(c[0]), V(c[1]), V(c[2]), V(c[3]));
    ASSERT_EQ(check(mesh, structure()), Ok) << check(mesh, structure());
  }
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_EQ(mesh.boundary_faces().count(), test::built(box).boundary_faces().count());
  EXPECT_EQ(mesh.n_faces(), test::built(box).n_faces());
}

TEST(AddCell, ToAMeshFromArrays) {
  TetMesh mesh = test::single_cell();
  const V top = mesh.add_vertex({1, 1, 1});
  const CellHandle c = mesh.add_cell(V(1), V(2), V(3), top);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_EQ(mesh.cell_cells(c)[0], CellHandle(0));
  EXPECT_EQ(mesh.incident_cell(top), c);
}

TEST(AddCell, RefusesAndLeavesTheMeshAlone) {
  TetMesh mesh = test::single_cell();
  const V top = mesh.add_vertex({1, 1, 1});
  const V far = mesh.add_vertex({2, 2, 2});
  EXPECT_THAT(message_of([&] { mesh.add_cell(V(1), V(3), V(2), top); }),
              testing::HasSubstr("wrong way round"));
  EXPECT_THAT(message_of([&] { mesh.add_cell(V(1), V(2), V(2), top); }),
              testing::HasSubstr("two are the same"));
  EXPECT_THAT(message_of([&] { mesh.add_cell(V(1), V(2), V(9), top); }),
              testing::HasSubstr("vertex 9 does not exist"));
  mesh.add_cell(V(1), V(2), V(3), top);
  EXPECT_THAT(message_of([&] { mesh.add_cell(V(1), V(2), V(3), far); }),
              testing::HasSubstr("two cells already"));
  EXPECT_EQ(mesh.n_cells(), 2U);
  EXPECT_EQ(check(mesh), Ok);
  mesh.delete_vertex(far);
  EXPECT_THROW(mesh.add_cell(V(0), V(1), V(2), far), InvalidInput);
}

TEST(AddCell, RefusesTheVerticesOfACellInAnyOrder) {
  TetMesh mesh = test::single_cell();
  for (const Corners& c : {Corners{0, 1, 2, 3}, Corners{0, 2, 1, 3}, Corners{1, 2, 3, 0}})
    EXPECT_THAT(message_of([&] { mesh.add_cell(V(c[0]), V(c[1]), V(c[2]), V(c[3])); }),
                testing::HasSubstr("cell 0 has the same four vertices"));
  EXPECT_EQ(mesh.n_cells(), 1U);
  EXPECT_EQ(mesh.boundary_faces().count(), 4U);
}

TEST(AddCell, AfterLowLevelWritingFindsItsNeighbours) {
  TetMesh mesh = test::single_cell();
  const V top = mesh.add_vertex({1, 1, 1});
  mesh.delete_cell(mesh.add_cell(V(1), V(2), V(3), top));  // the table of faces is now there
  const V low = mesh.add_vertex({-1, -1, -1});
  TetMesh::Writer(mesh).cell(CellHandle(0)).v[0] = low;
  TetMesh::Writer(mesh).set_incident_cell(low, CellHandle(0));
  TetMesh::Writer(mesh).set_incident_cell(V(0), CellHandle());
  const CellHandle c = mesh.add_cell(low, V(2), V(1), V(0));
  EXPECT_EQ(mesh.cell_cells(c).size(), 1U);
  EXPECT_EQ(check(mesh), Ok);
}

TEST(DeleteCell, EveryCellInRandomOrder) {
  for (const auto& [name, original] : test::suite()) {
    TetMesh mesh = original;
    for (std::size_t i : shuffled(mesh.n_cells(), 3)) {
      mesh.delete_cell(CellHandle(i));
      ASSERT_EQ(check(mesh, structure()), Ok) << name << " " << check(mesh, structure());
    }
    EXPECT_EQ(mesh.n_logical_cells(), 0U);
    EXPECT_EQ(mesh.n_faces() + mesh.n_edges(), 0U);
    EXPECT_EQ(unused_vertices(mesh).size(), mesh.n_vertices());
    EXPECT_THROW(mesh.delete_cell(CellHandle(0)), InvalidInput);
  }
}

TEST(DeleteCell, AfterLowLevelWritingHashesNoFaces) {
  TetMesh mesh = test::kuhn_box(10);
  TetMesh::Writer(mesh).cell(CellHandle(0));  // as an operator writes
  const std::size_t before = mesh.memory_bytes();
  mesh.delete_cell(CellHandle(mesh.n_cells() / 2));
  EXPECT_LT(mesh.memory_bytes() - before, 64U) << "a table over the whole mesh was made";
  EXPECT_EQ(check(mesh, structure()), Ok);
  for (std::size_t i : shuffled(mesh.n_cells(), 3)) {
    if (mesh.is_deleted(CellHandle(i))) continue;
    if (i % 16 == 0) TetMesh::Writer(mesh).cell(CellHandle(i));
    mesh.delete_cell(CellHandle(i));
    if (i % 32 != 0) continue;
    ASSERT_EQ(check(mesh, structure()), Ok) << check(mesh, structure());
  }
  EXPECT_EQ(unused_vertices(mesh).size(), mesh.n_vertices());
}

TEST(DeleteCell, KeepsTheLabelOfAnEdgeThatAnotherPartOfTheMeshHas) {
  // Two cells that have the edge 0-1 in common and no face.
  const std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  TetMesh mesh = build(points, std::vector<Corners>{{0, 1, 2, 3}, {0, 1, 4, 5}});
  mesh.labels().edges.set({V(0), V(1)}, 1);
  mesh.delete_cell(CellHandle(0));
  EXPECT_EQ(mesh.labels().edges.size(), 1U);
  mesh.delete_cell(CellHandle(1));
  EXPECT_TRUE(mesh.labels().edges.empty());
}

TEST(DeleteVertex, TakesItsCellsAlongAlsoThoseThatTouchInItAlone) {
  const std::vector<Vec3> points = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {0, 0, 1},
                                    {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  TetMesh mesh = build(points, std::vector<Corners>{{0, 1, 2, 3}, {0, 4, 6, 5}});
  mesh.delete_vertex(V(0));
  EXPECT_EQ(mesh.n_logical_cells(), 0U);
  EXPECT_EQ(mesh.n_logical_vertices(), 6U);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_THROW(mesh.delete_vertex(V(0)), InvalidInput);
}

TEST(DeleteVertex, EveryVertexInRandomOrder) {
  TetMesh mesh = test::carved_ball(5);
  for (std::size_t i : shuffled(mesh.n_vertices(), 5)) {
    mesh.delete_vertex(VertexHandle(i));
    ASSERT_EQ(check(mesh, structure()), Ok) << check(mesh, structure());
  }
  EXPECT_EQ(mesh.n_logical_vertices(), 0U);
  EXPECT_EQ(mesh.n_logical_cells(), 0U);
}

TEST(DeleteCell, DropsLabelsOfWhatVanishes) {
  TetMesh mesh = test::kuhn_box(2);
  for (FaceHandle f : mesh.boundary_faces()) mesh.labels().faces.set(mesh.face_vertices(f), 1);
  for (EdgeHandle e : mesh.boundary_edges()) mesh.labels().edges.set(mesh.edge_vertices(e), 2);
  for (std::size_t i : shuffled(mesh.n_cells(), 11)) {
    mesh.delete_cell(CellHandle(i));
    ASSERT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok);
    const test::Oracle oracle(mesh);
    for (const auto& entry : mesh.labels().faces.entries())
      ASSERT_TRUE(oracle.faces().contains(AnyOrder::key(entry.vertices)));
    for (const auto& entry : mesh.labels().edges.entries())
      ASSERT_TRUE(oracle.edges().contains(AnyOrder::key(entry.vertices)));
  }
  EXPECT_TRUE(mesh.labels().faces.empty());
  EXPECT_TRUE(mesh.labels().edges.empty());
}

TEST(AddAndDelete, MixedAtRandomAgreeWithTheOracle) {
  TetMesh mesh = test::kuhn_box(2);
  std::vector<std::array<VertexHandle, 4>> removed;
  std::size_t added = 0;
  for (std::uint64_t step = 0; step < 300; ++step) {
    const double r = generate::random_unit(99, step);
    if (generate::random_unit(98, step) < 0.5 || removed.empty()) {
      const auto cells = test::vector_of(mesh.cells());
      if (cells.empty()) continue;
      const CellHandle c = cells[static_cast<std::size_t>(r * static_cast<double>(cells.size()))];
      removed.push_back(mesh.cell(c).v);
      mesh.delete_cell(c);
    } else {
      const std::size_t i = static_cast<std::size_t>(r * static_cast<double>(removed.size()));
      mesh.add_cell(removed[i][0], removed[i][1], removed[i][2], removed[i][3]);
      removed.erase(removed.begin() + static_cast<std::ptrdiff_t>(i));
      ++added;
    }
    ASSERT_EQ(check(mesh, structure()), Ok) << check(mesh, structure());
    if (step % 20 == 0) {
      ASSERT_EQ(mesh.n_faces(), test::Oracle(mesh).faces().size());
    }
  }
  EXPECT_GT(added, 50U) << "the walk no longer adds cells";
  EXPECT_EQ(mesh.n_logical_cells() + removed.size(), 48U);
}

}  // namespace
}  // namespace hfr
