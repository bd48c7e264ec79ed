// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/SmoothCandidates.hh"

#include "Operators/SmoothStars.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<SmoothCandidates<VolumeLength>>);

TEST(SmoothCandidates, CentreOfAnOctahedronReturnsToTheMiddle) {
  TetMesh mesh = octahedron({0.5, -0.3, 0.2});
  const auto quality = qualities(mesh, VolumeLength{});
  const auto frozen = frozen_vertices(mesh);
  ASSERT_TRUE(apply(SmoothCandidates<VolumeLength>{{}, quality, frozen}, mesh, V(0)));
  EXPECT_LT(norm(mesh.point(V(0))), 0.02);
}

TEST(SmoothCandidates, MovesRaiseTheWorstWithEachMetric) {
  EXPECT_GT(smooth_stars(CandidateSearch{}, VolumeLength{}, 0.3, 8).moved, 150);
  EXPECT_GT(smooth_stars(CandidateSearch{}, MinSine2{}, 0.3, 4).moved, 75);
  EXPECT_GT(smooth_stars(CandidateSearch{}, MinDihedral{}, 0.3, 4).moved, 75);
}

TEST(SmoothCandidates, InvertedStarsAreUntangled) {
  const SmoothTally tally = smooth_stars(CandidateSearch{}, VolumeLength{}, 0.6, 8);
  EXPECT_GT(tally.tangled, 100);
  EXPECT_GT(tally.untangled, tally.tangled / 5);
}

TEST(SmoothCandidates, MoreHalvingsFindNoWorsePlace) {
  const TetMesh mesh = jittered(4, 0.3, 3);
  const auto quality = qualities(mesh, VolumeLength{});
  const auto frozen = frozen_vertices(mesh);
  int better = 0;
  for (VertexHandle v : mesh.vertices()) {
    const auto coarse =
        SmoothCandidates<VolumeLength>{{}, quality, frozen, CandidateSearch{3}}.evaluate(mesh, v);
    const auto fine =
        SmoothCandidates<VolumeLength>{{}, quality, frozen, CandidateSearch{12}}.evaluate(mesh, v);
    if (!coarse) continue;
    ASSERT_TRUE(fine);
    EXPECT_GE(fine->new_worst, coarse->new_worst - 1e-14);
    better += fine->new_worst > coarse->new_worst ? 1 : 0;
  }
  EXPECT_GT(better, 10);
}

TEST(SmoothCandidates, UsersMetricIsJudgedByItself) {
  // The user wants edge length ratios; the search must not fall back to volume-length.
  const CustomMetric metric(
      [](Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return quality(Metric::kEdgeRatio, a, b, c, d); });
  EXPECT_GT(smooth_stars(CandidateSearch{}, metric, 0.3, 3).moved, 40);
}

}  // namespace
}  // namespace hfr::test
