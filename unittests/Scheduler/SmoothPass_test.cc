// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/SmoothPass.hh"

#include <gtest/gtest.h>

#include <array>

#include "HalfFace/Check.hh"
#include "Operators/LimitMeshes.hh"
#include "Operators/Metrics.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/SmoothLaplacian.hh"
#include "Operators/SmoothMaxMin.hh"
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

/// Moves vertex 0, which has 2·n_ring cells, back from where it spoils them.
template <class Search, class Metric>
void expect_hub_moves(Index n_ring, const Search& search, const Metric& metric) {
  TetMesh mesh = built(hub(n_ring));
  mesh.set_point(V(0), {0.3, 0.2, 0.6});
  Workspace work;
  work.attach(mesh, {});
  work.set_qualities(mesh, metric, {});
  ASSERT_EQ(work.star_size[0], 2 * n_ring);
  const auto star_worst = [&] {
    double worst = std::numeric_limits<double>::infinity();
    for (CellHandle c : mesh.vertex_cells(V(0))) worst = std::min(worst, work.quality[c.idx()]);
    return worst;
  };
  const double before = star_worst();
  EXPECT_GT(before, 0);
  const RoundCounts counts = smooth_pass(mesh, work, search, metric, std::vector<VertexHandle>{V(0)}, {});
  EXPECT_EQ(counts.winners, 1U) << n_ring << " cells in the ring";
  EXPECT_GT(star_worst(), before);
  EXPECT_EQ(work.quality, qualities(mesh, metric));
}

TEST(SmoothPass, VertexOfMoreThan256CellsMovesByEverySearch) {
  for (const Index n : {Index{128}, Index{129}, Index{300}}) {  // 256, 258 and 600 cells
    expect_hub_moves(n, NewtonSearch{}, VolumeLength{});
    expect_hub_moves(n, CandidateSearch{}, VolumeLength{});
    expect_hub_moves(n, MaxMinSearch{}, MinSine2{});
    expect_hub_moves(n, MaxMinSearch{}, MinDihedral{});
    expect_hub_moves(n, LaplacianSearch{}, VolumeLength{});
  }
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
  std::array<std::size_t, 2> winners{};  // forth and back
  for (int i = 0; i < 5; ++i) {
    for (const LaplacianSearch& step : {kTaubinForth, kTaubinBack}) {
      winners[step.step > 0 ? 0 : 1] += smooth_pass(mesh, work, step, VolumeLength{}, vertices, {}).winners;
      const double now = *std::min_element(work.quality.begin(), work.quality.end());
      EXPECT_GE(now, worst);
      worst = now;
    }
  }
  EXPECT_GT(winners[0], 0U);
  EXPECT_GT(winners[1], 0U);
}

TEST(SmoothPass, InvertedAndFlatCellsNeverBecomeMore) {
  std::size_t winners = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    TetMesh mesh = jittered(4, 0.9, seed);
    for (VertexHandle v : mesh.vertices()) {
      const Vec3 p = mesh.point(v);
      mesh.set_point(v, {std::round(12 * p.x), std::round(12 * p.y), std::round(12 * p.z)});
    }
    Workspace work;
    work.attach(mesh, {});
    work.set_qualities(mesh, Untangling{1e-3}, {});
    std::vector<VertexHandle> vertices;
    for (VertexHandle v : mesh.vertices())
      if (!work.frozen[v.idx()]) vertices.push_back(v);
    for (int i = 0; i < 5; ++i) {
      Damage before, after;
      for (CellHandle c : mesh.cells()) before.add(mesh, c);
      winners += smooth_pass(mesh, work, CandidateSearch{}, Untangling{1e-3}, vertices, {}).winners;
      for (CellHandle c : mesh.cells()) after.add(mesh, c);
      EXPECT_LE(after.n_inverted(), before.n_inverted());
      EXPECT_LE(after.n_invalid(), before.n_invalid());
    }
  }
  EXPECT_GT(winners, 200U);
}

}  // namespace
}  // namespace hfr::test
