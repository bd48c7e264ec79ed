// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceSwap.hh"

#include <gtest/gtest.h>

#include "Surface/Skin.hh"

namespace hfr::test {
namespace {

/// Four vertices of the unit square's corners on the plane z = 0 and one above: two cells, whose diagonal is
/// the wrong one for an apex above a corner.
TEST(SurfaceSwap, DiagonalThatFlattensACellGivesWay) {
  TetMesh mesh = build({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.9, 0.05, 0.6}},
                       std::vector<Corners>{{0, 1, 2, 4}, {0, 2, 3, 4}});
  ASSERT_EQ(check(mesh), Ok);
  SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
  const auto quality = values(mesh);
  const double before = worst(mesh);
  ASSERT_TRUE(surface.may_swap(V(0), V(2)));
  EXPECT_FALSE(surface.may_swap(V(0), V(1)));
  const auto plan =
      try_on(SurfaceSwap<VolumeLength>{{}, quality, &surface}, mesh, mesh.find_edge(V(0), V(2)));
  ASSERT_TRUE(plan);
  surface.on_swap(V(0), V(2));
  EXPECT_TRUE(surface.in_step(mesh));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_FALSE(mesh.find_edge(V(0), V(2)).is_valid());
  EXPECT_TRUE(mesh.find_edge(V(1), V(3)).is_valid());
  EXPECT_GT(worst(mesh), before);
}

TEST(SurfaceSwap, FlatCellUnderTwoFacesIsPeeledOff) {
  // A regular octahedron's upper half over a square that an all but flat cell covers from below.
  TetMesh mesh = build({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.8}},
                       std::vector<Corners>{{0, 1, 3, 4}, {1, 2, 3, 4}, {0, 2, 1, 3}});
  SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
  EXPECT_EQ(worst(mesh), 0);
  const auto quality = values(mesh);
  const auto plan =
      try_on(SurfaceSwap<VolumeLength>{{}, quality, &surface}, mesh, mesh.find_edge(V(0), V(2)));
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->n_removed, 3U);
  EXPECT_EQ(plan->n_created, 2U);
  surface.on_swap(V(0), V(2));
  EXPECT_TRUE(surface.in_step(mesh));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(worst(mesh), 0);
}

}  // namespace
}  // namespace hfr::test
