// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/AnyCost.hh"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "Remesh/Beside.hh"
#include "Remesh/MayRise.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/Polish.hh"
#include "Remesh/StageBench.hh"

namespace hfr::test {
namespace {

ImproveOptions at_any_cost() {
  ImproveOptions options = serial();
  options.raise_min_dihedral = true;
  return options;
}

/// Moves the vertices that may move towards the middle of the unit box by `share` of the way.
void contract(TetMesh& mesh, const std::vector<std::uint8_t>& frozen, double share) {
  for (VertexHandle v : mesh.vertices())
    if (frozen[v.idx()] == 0)
      mesh.set_point(v, mesh.point(v) + share * (Vec3{0.5, 0.5, 0.5} - mesh.point(v)));
}

TEST(AnyCost, WhatFellBelowTheBestWorstAngleIsMendedBeforeAMeshIsJudged) {
  int n = 0, n_beside = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    TetMesh mesh = jittered(5, 0.2, seed);
    if (seed > 6) mesh = beside_slivers(mesh, 1);  // whose worst angle stays, whatever the others come to
    StageBench bench(mesh, at_any_cost());
    AnyCostEffort effort = *bench.run.strategy.any_cost;
    effort.targets = {{1}};  // which no cell misses, so that the climb does nothing by itself
    effort.patches.clear();
    effort.refine.reset();
    effort.refine_again.reset();
    Best best(bench.run, effort.may_fall);
    const double before = smallest_that_may_rise(bench.run, kLargestGoal);
    ASSERT_EQ(best.risen(), before);
    contract(mesh, bench.run.work.frozen, 0.01);
    const double lowered = smallest_that_may_rise(bench.run, kLargestGoal);
    ASSERT_GT(lowered, 1.1);
    if (!(lowered < before)) continue;
    ++(seed > 6 ? n_beside : n);
    raise_at_any_cost(bench.run, effort, best);
    EXPECT_GE(smallest_that_may_rise(bench.run, kLargestGoal), before) << seed;
    EXPECT_EQ(check(mesh), Ok);
  }
  EXPECT_GT(n, 2);
  EXPECT_GT(n_beside, 2);
}

TEST(AnyCost, MendingGoesOnWhileTheWorstRisesByLittle) {
  int usual = 0, mending = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    TetMesh first = jittered(5, 0.28, seed);
    ImproveOptions options = serial();
    options.ops = Ops::kSmooth;
    improve(first, options);
    const double before = smallest_dihedral(first, {});
    const auto is_back = [&](bool any_gain) {
      TetMesh mesh = first;
      StageBench bench(mesh, options);
      contract(mesh, bench.run.work.frozen, 0.05);
      const Strategy& strategy = bench.run.strategy;
      polish(bench.run, any_gain ? strategy.mending() : strategy.polish, before);
      return smallest_dihedral(mesh, {}) >= before;
    };
    usual += is_back(false) ? 1 : 0;
    mending += is_back(true) ? 1 : 0;
  }
  EXPECT_GT(mending, usual);
}

}  // namespace
}  // namespace hfr::test
