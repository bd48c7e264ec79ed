// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/SmoothLaplacian.hh"

#include "Operators/SmoothStars.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<SmoothLaplacian<VolumeLength>>);

TEST(SmoothLaplacian, VertexGoesToTheMeanOfItsNeighbours) {
  TetMesh mesh = octahedron({0.5, -0.3, 0.2});
  const auto quality = qualities(mesh, VolumeLength{});
  const auto frozen = frozen_vertices(mesh);
  const SmoothLaplacian<VolumeLength> op{{}, quality, frozen};
  const auto plan = op.evaluate(mesh, V(0));
  ASSERT_TRUE(plan);
  EXPECT_LT(norm(plan->target), 1e-15);
}

TEST(SmoothLaplacian, NeighboursCountOnceHoweverManyFacesTheyHave) {
  const TetMesh mesh = jittered(4, 0.3, 2);
  const auto quality = qualities(mesh, VolumeLength{});
  const auto frozen = frozen_vertices(mesh);
  int moved = 0;
  for (VertexHandle v : mesh.vertices()) {
    Vec3 sum;
    double n = 0;
    for (VertexHandle w : mesh.vertex_vertices(v)) {
      sum = sum + mesh.point(w);
      ++n;
    }
    const Vec3 home = mesh.point(v);
    const Vec3 mean = (1 / n) * sum;
    const auto whole = SmoothLaplacian<VolumeLength>{{}, quality, frozen}.evaluate(mesh, v);
    const auto third = SmoothLaplacian<VolumeLength>{{}, quality, frozen, kTaubinForth}.evaluate(mesh, v);
    if (!whole || !third) continue;
    ++moved;
    EXPECT_LT(norm(whole->target - mean), 1e-14);
    EXPECT_LT(norm(third->target - (home + 0.33 * (mean - home))), 1e-14);
  }
  EXPECT_GT(moved, 5);
}

TEST(SmoothLaplacian, MovesThatLowerTheWorstAreRefused) {
  const SmoothTally whole = smooth_stars(LaplacianSearch{}, VolumeLength{}, 0.3, 8);
  EXPECT_GT(whole.moved, 50);
  EXPECT_LT(whole.moved, whole.tried) << "the guard refuses nothing";
  const SmoothTally forth = smooth_stars(kTaubinForth, VolumeLength{}, 0.3, 8);
  const SmoothTally back = smooth_stars(kTaubinBack, VolumeLength{}, 0.3, 8);
  EXPECT_GT(forth.moved, 50);
  EXPECT_GT(back.moved, 0);
  EXPECT_LT(back.moved, forth.moved);
}

}  // namespace
}  // namespace hfr::test
