// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Coordinates.hh"

#include <gmock/gmock.h>

#include "HalfFace/Errors.hh"
#include "Remesh/ImproveTriangles.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

TetMesh placed_box(double scale, double offset) {
  TetMesh mesh = jittered(4, 0.3, 1);
  for (VertexHandle v : mesh.vertices())
    mesh.set_point(v, scale * mesh.point(v) + Vec3{offset, offset, offset});
  return mesh;
}

/// What improve() says of the mesh; empty when it takes it. Left as it was when refused.
std::string refusal(double scale, double offset, SurfaceMode mode = SurfaceMode::kFrozen) {
  TetMesh mesh = placed_box(scale, offset);
  const TetMesh before = mesh;
  ImproveOptions options = serial();
  options.surface.mode = mode;
  options.iterations = 1;
  try {
    improve(mesh, options);
  } catch (const InvalidInput& error) {
    EXPECT_TRUE(identical(mesh, before));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return {};
}

TEST(Coordinates, OutOfTheRangeOfProductsAreRefused) {
  EXPECT_THAT(refusal(1e300, 0), testing::HasSubstr("scale the mesh"));
  EXPECT_THAT(refusal(1e60, 0), testing::HasSubstr("1e+60"));
  EXPECT_THAT(refusal(1e-60, 0), testing::HasSubstr("scale the mesh"));
  EXPECT_THAT(refusal(1e-300, 0), testing::HasSubstr("scale the mesh"));
  EXPECT_EQ(refusal(1e28, 0), "");
  EXPECT_EQ(refusal(1e-22, 0), "");
}

TEST(Coordinates, CoarserThanTheCellsAreRefused) {
  for (const SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat}) {
    EXPECT_THAT(refusal(1e-3, 1e12, mode), testing::HasSubstr("move it towards the origin"));
    EXPECT_THAT(refusal(1e-2, 1e12, mode), testing::HasSubstr("0.000122 apart"));
  }
  EXPECT_EQ(refusal(1, 1e12), "");
  EXPECT_EQ(refusal(1, 1e9), "");
}

TEST(Coordinates, ScalingByAPowerOfTwoChangesNothingElse) {
  TetMesh one = placed_box(1, 0);
  TetMesh large = placed_box(0x1p80, 0);
  improve(one, serial());
  improve(large, serial());
  ASSERT_EQ(one.n_cells(), large.n_cells());
  for (std::size_t i = 0; i < one.n_vertices(); ++i)
    EXPECT_TRUE(0x1p80 * one.point(V(i)) == large.point(V(i)));
}

TEST(Coordinates, AllInOnePointOrOfUnusedVerticesAreNotRefused) {
  TetMesh point = placed_box(0, 7);
  require_sound_coordinates(point, {});
  TetMesh mesh = placed_box(1, 0);
  mesh.add_vertex({1e200, 0, 0});
  require_sound_coordinates(mesh, {3, 1});
}

TEST(Coordinates, OfASurfaceAloneAreJudgedAlike) {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{V(0), V(1), V(2)}, {V(0), V(2), V(3)}};
  require_sound_coordinates(mesh);
  for (Vec3& p : mesh.points) p = 1e200 * p;
  EXPECT_THROW(require_sound_coordinates(mesh), InvalidInput);
  for (Vec3& p : mesh.points) p = 1e-200 * p + Vec3{1e15, 0, 0};
  EXPECT_THROW(require_sound_coordinates(mesh), InvalidInput);
}

}  // namespace
}  // namespace hfr::test
