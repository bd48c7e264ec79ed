// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/EigenPoints.hh"

#include <gtest/gtest.h>

#include "Meshes.hh"

namespace hfr {
namespace {

TEST(EigenPoints, AreTheMeshItself) {
  TetMesh mesh = test::kuhn_box(2);
  auto points = eigen_points(mesh);
  ASSERT_EQ(points.cols(), 27);
  points.row(2).array() += 1.0;
  EXPECT_EQ(mesh.point(VertexHandle(26)), (Vec3{1, 1, 2}));
  const TetMesh& seen = mesh;
  const Eigen::Vector3d centre = eigen_points(seen).rowwise().mean();
  EXPECT_TRUE(centre.isApprox(Eigen::Vector3d(0.5, 0.5, 1.5)));
  mesh.set_point(VertexHandle(0), from_eigen(centre));
  EXPECT_EQ(to_eigen(mesh.point(VertexHandle(0))), centre);
}

TEST(EigenPoints, EmptyMesh) {
  TetMesh mesh;
  EXPECT_EQ(eigen_points(mesh).cols(), 0);
}

}  // namespace
}  // namespace hfr
