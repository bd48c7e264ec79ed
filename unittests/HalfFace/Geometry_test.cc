// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Geometry.hh"

#include <gtest/gtest.h>

#include "Meshes.hh"

namespace hfr {
namespace {

using V = VertexHandle;

TEST(Geometry, OfOneCell) {
  const TetMesh mesh = test::single_cell();
  const HalfEdgeHandle e = mesh.find_halfedge(V(2), V(1));
  EXPECT_EQ(vector(mesh, e), (Vec3{1, -1, 0}));
  EXPECT_DOUBLE_EQ(length(mesh, e), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(length(mesh, mesh.edge_handle(e)), std::sqrt(2.0));
  EXPECT_EQ(barycenter(mesh, mesh.edge_handle(e)), (Vec3{0.5, 0.5, 0}));
  EXPECT_EQ(barycenter(mesh, CellHandle(0)), (Vec3{0.25, 0.25, 0.25}));
  EXPECT_EQ(barycenter(mesh, V(3)), (Vec3{0, 0, 1}));
  EXPECT_DOUBLE_EQ(volume(mesh, CellHandle(0)), 1.0 / 6);
  const HalfFaceHandle floor = mesh.vertex_opposite_halfface(CellHandle(0), V(3));
  EXPECT_EQ(normal(mesh, floor), (Vec3{0, 0, 1})) << "into the cell";
  EXPECT_DOUBLE_EQ(area(mesh, mesh.face_handle(floor)), 0.5);
  EXPECT_LT(norm(barycenter(mesh, mesh.face_handle(floor)) - Vec3{1.0 / 3, 1.0 / 3, 0}), 1e-15);
}

TEST(Geometry, NormalsPointFromTheBoundaryIntoTheMesh) {
  const TetMesh mesh = test::kuhn_box(2);
  for (HalfFaceHandle h : mesh.boundary_halffaces())
    EXPECT_GT(dot(normal(mesh, h), barycenter(mesh, mesh.incident_cell(h)) - barycenter(mesh, h)), 0);
  for (HalfFaceHandle h : mesh.halffaces())
    if (const HalfFaceHandle m = mesh.opposite_halfface(h); m.is_valid()) {
      EXPECT_LT(norm(normal(mesh, h) + normal(mesh, m)), 1e-12);
    }
}

TEST(Geometry, InvertedCellHasNegativeVolume) {
  TetMesh mesh = test::single_cell();
  mesh.set_point(V(3), {0, 0, -1});
  EXPECT_DOUBLE_EQ(volume(mesh, CellHandle(0)), -1.0 / 6);
}

}  // namespace
}  // namespace hfr
