// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/SmoothPass.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/SmoothLaplacian.hh"
#include "Operators/SmoothNewton.hh"

namespace hfr::test {
namespace {

struct Smoothed {
  TetMesh mesh;
  Workspace work;
  RoundCounts counts;
};

template <class Search, class Metric>
Smoothed smooth(const Search& search, const Metric& metric, double jitter, int passes, par::Policy policy) {
  Smoothed run{jittered(6, jitter, 5), {}, {}};
  run.work.attach(run.mesh, policy);
  run.work.set_qualities(run.mesh, metric, policy);
  std::vector<VertexHandle> vertices;
  for (VertexHandle v : run.mesh.vertices())
    if (!run.work.frozen[v.idx()]) vertices.push_back(v);
  double worst = *std::min_element(run.work.quality.begin(), run.work.quality.end());
  for (int i = 0; i < passes; ++i) {
    run.counts += smooth_pass(run.mesh, run.work, search, metric, vertices, policy);
    EXPECT_EQ(run.work.quality, qualities(run.mesh, metric)) << "cached qualities are not the mesh's";
    const double now = *std::min_element(run.work.quality.begin(), run.work.quality.end());
    EXPECT_GE(now, worst) << "the worst cell got worse";
    worst = now;
  }
  EXPECT_EQ(check(run.mesh), Ok);
  return run;
}

template <class Search, class Metric>
void expect_equal_for_threads(const Search& search, const Metric& metric, double jitter) {
  const Smoothed one = smooth(search, metric, jitter, 3, {1, 1});
  EXPECT_GT(one.counts.winners, 40U);
  for (const int threads : {2, 3, 7}) {
    const Smoothed many = smooth(search, metric, jitter, 3, {threads, 1});
    EXPECT_TRUE(identical(one.mesh, many.mesh)) << threads << " threads";
    EXPECT_EQ(one.work.quality, many.work.quality);
    EXPECT_EQ(one.work.changed, many.work.changed);
    EXPECT_EQ(one.counts.winners, many.counts.winners);
  }
}

TEST(SmoothPass, WorstNeverDropsAndThreadsDoNotMatter) {
  expect_equal_for_threads(NewtonSearch{}, VolumeLength{}, 0.3);
  expect_equal_for_threads(NewtonSearch{}, MinSine2{}, 0.3);
  expect_equal_for_threads(CandidateSearch{}, VolumeLength{}, 0.5);
  expect_equal_for_threads(LaplacianSearch{}, VolumeLength{}, 0.3);
}

TEST(SmoothPass, BoundaryStaysAndStampsFollowTheMoves) {
  const TetMesh before = jittered(6, 0.3, 5);
  const Smoothed run = smooth(NewtonSearch{}, VolumeLength{}, 0.3, 1, {});
  EXPECT_TRUE(boundary_of(run.mesh) == boundary_of(before));
  std::size_t moved = 0;
  for (VertexHandle v : before.vertices()) {
    if (before.point(v) == run.mesh.point(v)) continue;
    ++moved;
    for (CellHandle c : run.mesh.vertex_cells(v))
      for (VertexHandle u : run.mesh.cell(c).v) EXPECT_EQ(run.work.changed[u.idx()], run.work.clock);
  }
  EXPECT_EQ(moved, run.counts.winners);
  EXPECT_EQ(run.counts.seeds, 125U);
}

TEST(SmoothPass, TaubinsTwoStepsAreGuardedToo) {
  TetMesh mesh = jittered(6, 0.3, 6);
  Workspace work;
  work.attach(mesh, {});
  work.set_qualities(mesh, VolumeLength{}, {});
  std::vector<VertexHandle> vertices;
  for (VertexHandle v : mesh.vertices())
    if (!work.frozen[v.idx()]) vertices.push_back(v);
  double worst = *std::min_element(work.quality.begin(), work.quality.end());
  for (int i = 0; i < 5; ++i) {
    for (const LaplacianSearch& step : {kTaubinForth, kTaubinBack}) {
      smooth_pass(mesh, work, step, VolumeLength{}, vertices, {});
      const double now = *std::min_element(work.quality.begin(), work.quality.end());
      EXPECT_GE(now, worst);
      worst = now;
    }
  }
}

}  // namespace
}  // namespace hfr::test
