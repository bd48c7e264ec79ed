// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/SmoothMaxMin.hh"

#include "Operators/SmoothStars.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<SmoothMaxMin<MinSine2>>);
static_assert(LocalOperator<SmoothMaxMin<VolumeLength>>);

template <class Metric>
class SmoothMaxMinMetrics : public testing::Test {};
using AngleMetrics = testing::Types<MinSine2, MinDihedral>;
TYPED_TEST_SUITE(SmoothMaxMinMetrics, AngleMetrics);

TYPED_TEST(SmoothMaxMinMetrics, CentreOfAnOctahedronReturnsToTheMiddle) {
  for (const double scale : {1e-20, 1.0, 1e20}) {
    TetMesh mesh = octahedron({0.4, -0.2, 0.15});
    for (VertexHandle v : mesh.vertices()) mesh.set_point(v, scale * (mesh.point(v) + Vec3{3, 4, 5}));
    const auto quality = qualities(mesh, TypeParam{});
    const auto frozen = frozen_vertices(mesh);
    ASSERT_TRUE(apply(SmoothMaxMin<TypeParam>{{}, quality, frozen}, mesh, V(0))) << scale;
    EXPECT_LT(norm((1 / scale) * mesh.point(V(0)) - Vec3{3, 4, 5}), 1e-2) << scale;
  }
}

/// The largest worst value over a grid of places of the vertex: coarse, then finer round the best.
template <class Metric>
double best_on_grid(TetMesh mesh, VertexHandle v, const std::vector<CellHandle>& star, const Metric& metric) {
  constexpr int kSide = 5;
  Vec3 centre = mesh.point(v);
  const auto worst = [&](Vec3 x) {
    mesh.set_point(v, x);
    double w = std::numeric_limits<double>::infinity();
    for (CellHandle c : star) w = std::min(w, quality_of(mesh, mesh.cell(c).v, metric));
    return w;
  };
  double best = worst(centre);
  double reach = 0.12;
  for (int level = 0; level < 40; ++level) {
    const Vec3 home = centre;
    const double before = best;
    for (int i = -kSide; i <= kSide; ++i)
      for (int j = -kSide; j <= kSide; ++j)
        for (int k = -kSide; k <= kSide; ++k) {
          const Vec3 x = home + (reach / kSide) * Vec3{double(i), double(j), double(k)};
          const double w = worst(x);
          if (w > best) {
            best = w;
            centre = x;
          }
        }
    if (!(best > before)) reach *= 0.5;
    if (reach < 1e-4) break;
  }
  return best;
}

TYPED_TEST(SmoothMaxMinMetrics, AscentComesCloseToTheBestPlaceOnAGrid) {
  // The function has several peaks in an ugly star, and the grid may find a higher one.
  int tried = 0;
  int close = 0;
  for (std::uint64_t s = 1; s <= 3; ++s) {
    TetMesh mesh = jittered(4, 0.25, s);
    const auto quality = qualities(mesh, TypeParam{});
    const auto frozen = frozen_vertices(mesh);
    const SmoothMaxMin<TypeParam> op{{}, quality, frozen};
    for (VertexHandle v : mesh.vertices()) {
      if (frozen[v.idx()]) continue;
      std::vector<CellHandle> star;
      for (CellHandle c : mesh.vertex_cells(v)) star.push_back(c);
      double before = std::numeric_limits<double>::infinity();
      for (CellHandle c : star) before = std::min(before, quality[c.idx()]);
      if (before <= 0) continue;
      const auto plan = op.evaluate(mesh, v);
      const double grid = best_on_grid(mesh, v, star, TypeParam{});
      const double reached = plan ? plan->new_worst : before;
      ++tried;
      close += reached > 0.97 * grid ? 1 : 0;
    }
  }
  ASSERT_GT(tried, 70);
  EXPECT_GT(close, 0.8 * tried) << tried;
}

TYPED_TEST(SmoothMaxMinMetrics, GainIsMoreThanThatOfTheCandidateSearch) {
  const SmoothTally maxmin = smooth_stars(MaxMinSearch{}, TypeParam{}, 0.25, 10);
  const SmoothTally candidates = smooth_stars(CandidateSearch{}, TypeParam{}, 0.25, 10);
  ASSERT_GT(maxmin.moved, 200);
  EXPECT_GT(maxmin.sum_gain, candidates.sum_gain);
}

TEST(SmoothMaxMin, InvertedStarsAndOtherMetricsGoThroughTheCandidateSearch) {
  const SmoothTally tangled = smooth_stars(MaxMinSearch{}, MinSine2{}, 0.6, 4);
  const SmoothTally candidates = smooth_stars(CandidateSearch{}, MinSine2{}, 0.6, 4);
  EXPECT_GT(tangled.tangled, 50);
  EXPECT_EQ(tangled.untangled, candidates.untangled);
  const SmoothTally other = smooth_stars(MaxMinSearch{}, VolumeLength{}, 0.25, 4);
  EXPECT_GT(other.moved, 75);
  EXPECT_EQ(other.sum_gain, smooth_stars(CandidateSearch{}, VolumeLength{}, 0.25, 4).sum_gain);
}

}  // namespace
}  // namespace hfr::test
