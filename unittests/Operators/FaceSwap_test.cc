// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/FaceSwap.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/EdgeRemoval.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<FaceSwap<VolumeLength>>);

HalfFaceHandle inner_halfface(const TetMesh& mesh) {
  for (HalfFaceHandle h : mesh.halffaces())
    if (!mesh.is_boundary(h)) return h;
  return {};
}

TEST(FaceSwap, FlatPairBecomesThreeCellsRoundTheNewEdge) {
  TetMesh mesh = bipyramid(/*height=*/0.2);
  const double before = volume(mesh);
  const auto quality = qualities(mesh, VolumeLength{});
  ASSERT_TRUE(apply(FaceSwap<VolumeLength>{{}, quality}, mesh, inner_halfface(mesh)));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_NEAR(volume(mesh), before, 1e-15);
  EXPECT_EQ(ring_size(mesh, V(3), V(4)), 3U);
  EXPECT_GT(worst_quality(mesh, VolumeLength{}), *std::min_element(quality.begin(), quality.end()));
}

TEST(FaceSwap, TallPairIsLeftAlone) {
  const TetMesh mesh = bipyramid(/*height=*/1.4);
  const auto quality = qualities(mesh, VolumeLength{});
  EXPECT_FALSE((FaceSwap<VolumeLength>{{}, quality}.evaluate(mesh, inner_halfface(mesh))));
}

TEST(FaceSwap, BothHalfFacesOfAFaceGiveTheSameResult) {
  const TetMesh mesh = bipyramid(0.2);
  const auto quality = qualities(mesh, VolumeLength{});
  const FaceSwap<VolumeLength> op{{}, quality};
  const HalfFaceHandle h = inner_halfface(mesh);
  const HalfFaceHandle m = mesh.opposite_halfface(h);
  const auto a = op.evaluate(mesh, h);
  const auto b = op.evaluate(mesh, m);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->old_worst, b->old_worst);
  EXPECT_NEAR(a->new_worst, b->new_worst, 1e-14);
  EXPECT_EQ(op.identity(mesh, h), op.identity(mesh, m));
}

TEST(FaceSwap, EdgeRemovalTakesItBack) {
  TetMesh mesh = bipyramid(0.2);
  auto quality = qualities(mesh, VolumeLength{});
  ASSERT_TRUE(apply(FaceSwap<VolumeLength>{{}, quality}, mesh, inner_halfface(mesh)));
  mesh.set_point(V(3), {0, 0, 2.0});  // now tall: two cells are better
  mesh.set_point(V(4), {0, 0, -2.0});
  quality = qualities(mesh, VolumeLength{});
  ASSERT_TRUE(apply(EdgeRemoval<VolumeLength>{{}, quality}, mesh, edge_between(mesh, V(3), V(4))));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_EQ(mesh.n_logical_cells(), 2U);
  EXPECT_EQ(tets_of(mesh), tets_of(bipyramid(1)));
}

TEST(FaceSwap, BoundaryFacesAreRefused) {
  const TetMesh mesh = bipyramid(0.2);
  const std::vector<double> quality(mesh.n_cells(), -1.0);
  const FaceSwap<VolumeLength> op{{}, quality};
  int refused = 0;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    EXPECT_FALSE(op.evaluate(mesh, h));
    ++refused;
  }
  EXPECT_EQ(refused, 6);
}

TEST(FaceSwap, PlanClaimsTheWorstOfItsThreeCells) {
  Engine engine(5);
  int accepted = 0;
  for (int trial = 0; trial < 400; ++trial) {
    TetMesh mesh = bipyramid(uniform(engine, 0.05, 0.9));
    for (std::size_t i = 0; i < 5; ++i)
      mesh.set_point(V(i), mesh.point(V(i)) + random_point(engine, -0.3, 0.3));
    const auto quality = qualities(mesh, MinSine2{});
    const FaceSwap<MinSine2> op{{}, quality};
    const auto plan = op.evaluate(mesh, inner_halfface(mesh));
    const Tet ring = {V(0), V(1), V(2), V(0)};
    std::vector<Tet> three;
    for (std::size_t i = 0; i < 3; ++i) three.push_back({V(4), V(3), ring[i], ring[i + 1]});
    const double best = worst_of_tets(mesh, three, MinSine2{});
    const double old_worst = *std::min_element(quality.begin(), quality.end());
    if (!plan) {
      EXPECT_LE(best, old_worst + 1e-14);
      continue;
    }
    ++accepted;
    EXPECT_EQ(plan->old_worst, old_worst);
    EXPECT_NEAR(plan->new_worst, best, 1e-13);
    cavity_of(op, mesh, *plan);
  }
  EXPECT_GT(accepted, 100) << "the generator no longer makes swappable pairs";
}

}  // namespace
}  // namespace hfr::test
