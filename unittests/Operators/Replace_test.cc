// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Replace.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "HalfFace/Writer.hh"
#include "Operators/Clusters.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/VertexCollapse.hh"
#include "Operators/WriteCells.hh"

namespace hfr::test {
namespace {

TEST(Replace, CreatedCellsTakeTheSlotsOfTheRemovedAndThenTheFreeListFromItsBack) {
  TetMesh mesh = octahedron({0.97, 0, 0});
  {  // 8 cells become 4: four slots are freed
    const auto quality = qualities(mesh, VolumeLength{});
    const auto frozen = frozen_vertices(mesh);
    const VertexCollapse<VolumeLength> op{{}, quality, frozen};
    Scope scope;
    op.scope(mesh, V(0), scope);
    ASSERT_TRUE(apply(op, mesh, V(0)));
    const std::vector<CellHandle> expected(scope.begin() + 4, scope.end());
    EXPECT_EQ(mesh.free_cells(), expected);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_FALSE(mesh.is_deleted(scope[i]));
  }
  ASSERT_EQ(check(mesh), Ok);
  const CellHandle back = mesh.free_cells().back();
  // A swap makes three cells of two: it needs one slot more than it frees.
  for (HalfFaceHandle h : all_faces(mesh)) {
    if (mesh.is_boundary(h)) continue;
    FaceSwap<VolumeLength>::Plan plan;
    plan.seed = h;
    Cavity cavity;
    FaceSwap<VolumeLength>{}.cavity(mesh, plan, cavity);
    replace(mesh, cavity);
    break;
  }
  EXPECT_FALSE(mesh.is_deleted(back));
  EXPECT_EQ(mesh.free_cells().size(), 3U);
  EXPECT_EQ(mesh.n_cells(), 8U) << "nothing was appended";
  EXPECT_EQ(mesh.n_logical_cells(), 5U);
}

TEST(Replace, AppendsCellsWhenNoSlotIsFreeAndHandsOnWhatTheyInherit) {
  TetMesh mesh = bipyramid(0.2);
  mesh.set_region(C(0), 9);
  mesh.set_region(C(1), 9);
  auto field = mesh.request_cell_property<double>("density", 0.0);
  field[C(0)] = field[C(1)] = 2.5;
  const auto quality = qualities(mesh, VolumeLength{});
  for (HalfFaceHandle h : all_faces(mesh))
    if (!mesh.is_boundary(h)) {
      ASSERT_TRUE(apply(FaceSwap<VolumeLength>{{}, quality}, mesh, h));
      break;
    }
  ASSERT_EQ(mesh.n_cells(), 3U);
  for (CellHandle c : mesh.cells()) {
    EXPECT_EQ(mesh.region(c), 9);
    EXPECT_EQ(field[c], 2.5);
  }
}

TEST(Replace, NewVertexInheritsTheFieldsOfTheNearestOfItsCluster) {
  TetMesh mesh = octahedron();
  auto heat = mesh.request_vertex_property<double>("heat", 0.0);
  for (VertexHandle v : mesh.vertices()) heat[v] = 100.0 + static_cast<double>(v.idx());
  Cavity cavity;
  for (CellHandle c : mesh.cells()) {
    cavity.removed.push_back(c);
    const auto f = mesh.halfface_vertices(mesh.vertex_opposite_halfface(c, V(0)));
    cavity.created.push_back({f[0], f[1], f[2], Cavity::kNewVertex});
  }
  cavity.removed_vertex = V(0);
  cavity.new_vertex = Vec3{0.1, -0.6, 0.2};  // next to vertex 4
  replace(mesh, cavity);
  ASSERT_EQ(check(mesh), Ok);
  EXPECT_EQ(mesh.point(V(7)), *cavity.new_vertex);
  EXPECT_EQ(heat[V(7)], 104.0);
}

TEST(Replace, IncidentCellsAreLiveCellsOfTheirVertex) {
  TetMesh mesh = jittered(3, 0.35, 2);
  int committed = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
      for (Index e = 0; e < 6; ++e) {
        if (mesh.is_deleted(C(i))) continue;
        const auto quality = qualities(mesh, VolumeLength{});
        if (!apply(EdgeRemoval<VolumeLength>{{}, quality}, mesh, EdgeHandle(6 * i + e))) continue;
        ++committed;
        for (VertexHandle v : mesh.vertices()) {
          ASSERT_FALSE(mesh.is_deleted(mesh.incident_cell(v)));
          ASSERT_TRUE(mesh.cell(mesh.incident_cell(v)).has(v));
        }
      }
    }
  }
  EXPECT_GT(committed, 10);
}

TEST(Replace, MovesWriteOnlyThePoint) {
  TetMesh mesh = octahedron();
  const auto tets = tets_of(mesh);
  Cavity cavity;
  cavity.moved = V(0);
  cavity.target = {0.25, 0.5, 0.125};
  replace(mesh, cavity);
  EXPECT_EQ(mesh.point(V(0)), (Vec3{0.25, 0.5, 0.125}));
  EXPECT_EQ(tets_of(mesh), tets);
}

TEST(WriteCells, NeighboursAreLeftToTheCaller) {
  TetMesh mesh = jittered(2, 0.2, 1);
  HalfFaceHandle seed;
  for (HalfFaceHandle h : all_faces(mesh))
    if (!mesh.is_boundary(h)) seed = h;
  FaceSwap<VolumeLength>::Plan plan;
  plan.seed = seed;
  Cavity cavity;
  FaceSwap<VolumeLength>{}.cavity(mesh, plan, cavity);
  std::vector<Cell> before;
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) before.push_back(mesh.cell(C(i)));
  const std::size_t n = mesh.n_cells();
  TetMesh::Writer(mesh).resize_cells(n + 1);
  const std::array<CellHandle, 3> slots = {cavity.removed[0], cavity.removed[1], C(n)};
  std::vector<OuterFace> notes;
  write_cells(mesh, cavity, slots, VertexHandle(), notes);
  EXPECT_EQ(notes.size(), 6U);
  for (const OuterFace& note : notes) {
    EXPECT_TRUE(note.after.is_valid());
    EXPECT_EQ(mesh.opposite_halfface(note.after), note.behind);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (C(i) == slots[0] || C(i) == slots[1]) continue;
    EXPECT_EQ(mesh.cell(C(i)).v, before[i].v);
    EXPECT_EQ(mesh.cell(C(i)).mate, before[i].mate);
  }
}

}  // namespace
}  // namespace hfr::test
