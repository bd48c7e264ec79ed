// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Check.hh"

#include <gtest/gtest.h>

#include "HalfFace/Writer.hh"
#include "Meshes.hh"

namespace hfr {
namespace {

using test::kuhn_box;

CheckOptions structure() { return {.last = Rule::kDuplicateEdge}; }

TEST(Check, BuiltMeshesAreSound) {
  for (const auto& [name, mesh] : test::suite()) EXPECT_EQ(check(mesh, structure()), Ok) << name;
  EXPECT_EQ(check(kuhn_box(3)), Ok);
  EXPECT_EQ(check(TetMesh()), Ok);
}

TEST(Check, VertexOutOfRange) {
  TetMesh mesh = kuhn_box(1);
  TetMesh::Writer(mesh).cell(CellHandle(2)).v[1] = VertexHandle(8);
  const CheckResult result = check(mesh);
  EXPECT_EQ(result, Rule::kIndexRange);
  EXPECT_EQ(result.cells, std::vector{CellHandle(2)});
  EXPECT_EQ(result.vertices, std::vector{VertexHandle(8)});
}

TEST(Check, MateInADeletedCell) {
  TetMesh mesh = kuhn_box(1);
  TetMesh::Writer(mesh).mark_deleted(CellHandle(3));
  EXPECT_EQ(check(mesh), Rule::kIndexRange);
}

TEST(Check, VertexTwiceInACell) {
  TetMesh mesh = test::single_cell();
  TetMesh::Writer(mesh).cell(CellHandle(0)).v[1] = VertexHandle(0);
  EXPECT_EQ(check(mesh), Rule::kRepeatedVertex);
}

TEST(Check, DeletedCellThatIsNotFree) {
  TetMesh mesh = test::single_cell();
  TetMesh::Writer(mesh).resize_cells(2);
  EXPECT_EQ(check(mesh), Rule::kFreeList);
  TetMesh::Writer(mesh).free_cells().push_back(CellHandle(1));
  EXPECT_EQ(check(mesh), Ok);
  TetMesh::Writer(mesh).free_cells().push_back(CellHandle(1));
  EXPECT_EQ(check(mesh), Rule::kFreeList);
  TetMesh::Writer(mesh).free_cells().back() = CellHandle(0);
  EXPECT_EQ(check(mesh), Rule::kFreeList);
}

HalfFaceHandle inner_halfface(const TetMesh& mesh) {
  for (Index h = 0;; ++h)
    if (mesh.opposite_halfface(HalfFaceHandle(h)).is_valid()) return HalfFaceHandle(h);
}

TEST(Check, MateThatNamesAnother) {
  TetMesh mesh = kuhn_box(2);
  const HalfFaceHandle h = inner_halfface(mesh);
  TetMesh::Writer(mesh).set_mate(mesh.opposite_halfface(h), HalfFaceHandle());
  const CheckResult result = check(mesh);
  EXPECT_EQ(result, Rule::kMateSymmetry);
  ASSERT_EQ(result.halffaces.size(), 2U);
  EXPECT_EQ(result.halffaces[0], h);
}

TEST(Check, MatesOfDifferentVertices) {
  TetMesh mesh = kuhn_box(2);
  TetMesh::Writer(mesh).cell(CellHandle(5)).v[0] = VertexHandle(26);
  EXPECT_EQ(check(mesh), Rule::kSharedVertices);
}

TEST(Check, RenumberedCellContradictsItsNeighbours) {
  TetMesh mesh = kuhn_box(1);
  const CellHandle c(2);
  Cell& cell = TetMesh::Writer(mesh).cell(c);
  std::swap(cell.v[2], cell.v[3]);
  std::swap(cell.mate[2], cell.mate[3]);
  for (int k = 2; k < 4; ++k) {
    const HalfFaceHandle m = mesh.opposite_halfface(halfface_of(c, k));
    if (m.is_valid()) TetMesh::Writer(mesh).set_mate(m, halfface_of(c, k));
  }
  EXPECT_EQ(check(mesh), Rule::kOrientation);
}

TEST(Check, IncidentCellThatIsNoCellOfItsVertex) {
  TetMesh mesh = kuhn_box(2);
  TetMesh::Writer(mesh).set_incident_cell(VertexHandle(0), mesh.incident_cell(VertexHandle(26)));
  const CheckResult result = check(mesh);
  EXPECT_EQ(result, Rule::kIncidentCell);
  EXPECT_EQ(result.vertices, std::vector{VertexHandle(0)});
  TetMesh::Writer(mesh).set_incident_cell(VertexHandle(0), CellHandle());
  EXPECT_EQ(check(mesh), Rule::kIncidentCell);
}

TEST(Check, CellTwice) {
  TetMesh mesh = test::single_cell();
  TetMesh::Writer(mesh).resize_cells(2);
  TetMesh::Writer(mesh).cell(CellHandle(1)) = mesh.cell(CellHandle(0));
  const CheckResult result = check(mesh);
  EXPECT_EQ(result, Rule::kDuplicateFace);
  EXPECT_EQ(result.cells, (std::vector{CellHandle(0), CellHandle(1)}));
}

/// Three cells round the edge of the first two points, closed.
void append_ring(std::vector<Vec3>& points, std::vector<test::Corners>& cells) {
  const auto first = static_cast<Index>(points.size());
  points.insert(points.end(), {{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}});
  for (Index i = 0; i < 3; ++i) cells.push_back({0, 1, first + i, first + (i + 1) % 3});
}

TEST(Check, EdgeMadeTwice) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
  std::vector<test::Corners> cells;
  append_ring(points, cells);
  EXPECT_EQ(check(build(points, cells)), Ok);
  append_ring(points, cells);
  for (std::size_t i = 3; i < 6; ++i) cells[i][0] = 2, cells[i][1] = 3;
  TetMesh mesh = build(points, cells);
  EXPECT_EQ(check(mesh), Ok);
  for (std::size_t i = 3; i < 6; ++i) {  // build() would refuse it
    TetMesh::Writer(mesh).cell(CellHandle(i)).v[0] = VertexHandle(0);
    TetMesh::Writer(mesh).cell(CellHandle(i)).v[1] = VertexHandle(1);
  }
  TetMesh::Writer(mesh).set_incident_cell(VertexHandle(2), CellHandle());
  TetMesh::Writer(mesh).set_incident_cell(VertexHandle(3), CellHandle());
  const CheckResult result = check(mesh);
  EXPECT_EQ(result, Rule::kDuplicateEdge);
  EXPECT_EQ(result.vertices, (std::vector{VertexHandle(0), VertexHandle(1)}));
  EXPECT_EQ(result.cells, (std::vector{CellHandle(0), CellHandle(3)}));
}

TEST(Check, CellsThatTouchInAnEdge) {
  const std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  const TetMesh mesh = build(points, std::vector<test::Corners>{{0, 1, 2, 3}, {0, 1, 4, 5}});
  EXPECT_EQ(check(mesh), Rule::kNonManifoldEdge);
  EXPECT_EQ(check(mesh, structure()), Ok);
}

TEST(Check, CellsThatTouchInAVertex) {
  const std::vector<Vec3> points = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {0, 0, 1},
                                    {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const TetMesh mesh = build(points, std::vector<test::Corners>{{0, 1, 2, 3}, {0, 4, 6, 5}});
  const CheckResult result = check(mesh);
  EXPECT_EQ(result, Rule::kNonManifoldVertex);
  EXPECT_EQ(result.vertices, std::vector{VertexHandle(0)});
}

TEST(Check, LabelOnNoFace) {
  TetMesh mesh = kuhn_box(2);
  mesh.labels().faces.set(mesh.halfface_vertices(HalfFaceHandle(0)), 7);
  EXPECT_EQ(check(mesh), Ok);
  mesh.labels().faces.set({VertexHandle(0), VertexHandle(1), VertexHandle(26)}, 8);
  EXPECT_EQ(check(mesh), Rule::kLabel);
}

TEST(Check, UnusedVertexIsNoOffence) {
  TetMesh mesh = test::single_cell();
  const VertexHandle v = mesh.add_vertex({2, 2, 2});
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_EQ(unused_vertices(mesh), std::vector{v});
}

TEST(Check, MessageIsPrinted) {
  TetMesh mesh = test::single_cell();
  TetMesh::Writer(mesh).cell(CellHandle(0)).v[1] = VertexHandle(0);
  EXPECT_EQ(testing::PrintToString(check(mesh)), "kRepeatedVertex: cell 0 has a vertex twice");
}

}  // namespace
}  // namespace hfr
