// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/TetTopology.hh"

#include <gtest/gtest.h>

#include "Meshes.hh"

namespace hfr {
namespace {

using Triple = std::array<VertexHandle, 3>;

void expect_consistent(const TetMesh& mesh, const TetTopology& t) {
  const auto ends = [&](HalfEdgeHandle e) { return mesh.halfedge_vertices(e); };
  using Pair = std::array<VertexHandle, 2>;
  EXPECT_EQ(ends(t.ab()), (Pair{t.a(), t.b()}));
  EXPECT_EQ(ends(t.ac()), (Pair{t.a(), t.c()}));
  EXPECT_EQ(ends(t.ad()), (Pair{t.a(), t.d()}));
  EXPECT_EQ(ends(t.bc()), (Pair{t.b(), t.c()}));
  EXPECT_EQ(ends(t.bd()), (Pair{t.b(), t.d()}));
  EXPECT_EQ(ends(t.cd()), (Pair{t.c(), t.d()}));
  EXPECT_EQ(t.ba(), mesh.opposite_halfedge(t.ab()));
  EXPECT_EQ(t.ca(), mesh.opposite_halfedge(t.ac()));
  EXPECT_EQ(t.da(), mesh.opposite_halfedge(t.ad()));
  EXPECT_EQ(t.cb(), mesh.opposite_halfedge(t.bc()));
  EXPECT_EQ(t.db(), mesh.opposite_halfedge(t.bd()));
  EXPECT_EQ(t.dc(), mesh.opposite_halfedge(t.cd()));
  EXPECT_EQ(mesh.halfface_vertices(t.abc(), t.a()), (Triple{t.a(), t.b(), t.c()}));
  EXPECT_EQ(mesh.halfface_vertices(t.acd(), t.a()), (Triple{t.a(), t.c(), t.d()}));
  EXPECT_EQ(mesh.halfface_vertices(t.adb(), t.a()), (Triple{t.a(), t.d(), t.b()}));
  EXPECT_EQ(mesh.halfface_vertices(t.bdc(), t.b()), (Triple{t.b(), t.d(), t.c()}));
  EXPECT_EQ(mesh.halfface_opposite_vertex(t.opposite_a()), t.a());
  EXPECT_EQ(t.opposite_b(), t.acd());
  EXPECT_EQ(t.opposite_c(), t.adb());
  EXPECT_EQ(t.opposite_d(), t.abc());
}

TEST(TetTopology, NamesAgreeWhateverItBeginsWith) {
  const TetMesh mesh = test::kuhn_box(2);
  for (CellHandle c : mesh.cells()) {
    expect_consistent(mesh, TetTopology(mesh, c));
    for (VertexHandle v : mesh.cell_vertices(c)) {
      const TetTopology t(mesh, c, v);
      EXPECT_EQ(t.a(), v);
      EXPECT_EQ(t.cell(), c);
      expect_consistent(mesh, t);
    }
    for (HalfFaceHandle h : mesh.cell_halffaces(c)) {
      EXPECT_EQ(TetTopology(mesh, h).abc(), h);
      expect_consistent(mesh, TetTopology(mesh, h));
      for (VertexHandle v : mesh.halfface_vertices(h)) {
        const TetTopology t(mesh, h, v);
        EXPECT_EQ(t.abc(), h);
        EXPECT_EQ(t.a(), v);
        expect_consistent(mesh, t);
      }
      EXPECT_THROW(TetTopology(mesh, h, mesh.halfface_opposite_vertex(h)), InvalidInput);
    }
  }
}

}  // namespace
}  // namespace hfr
