// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Strategy.hh"

#include <gtest/gtest.h>

#include <vector>

namespace hfr::test {
namespace {

constexpr Survey kValid = {0.01, 0};
constexpr Survey kTangled = {-0.5, 3};
constexpr std::size_t kCells = 1000;

ImproveOptions options_in(SurfaceMode mode) {
  ImproveOptions options;
  options.surface.mode = mode;
  return options;
}

Strategy resolved(const ImproveOptions& options, const Survey& found = kValid) {
  return resolve(options, found, kCells);
}

void expect_bounds(const ImproveOptions& options, std::size_t min, std::size_t max) {
  const Strategy strategy = resolved(options);
  EXPECT_EQ(strategy.bounds.min, min);
  EXPECT_EQ(strategy.bounds.max, max);
}

TEST(Strategy, BoundsOnCellsAreThoseThatTheDocumentationNames) {
  for (const SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat, SurfaceMode::kFree}) {
    const bool frozen = mode == SurfaceMode::kFrozen, flat = mode == SurfaceMode::kFlat;
    SCOPED_TRACE(static_cast<int>(mode));
    ImproveOptions options = options_in(mode);
    expect_bounds(options, frozen ? 810 : 0, frozen ? 1190 : 1500);
    options.min_dihedral = 20;
    expect_bounds(options, frozen ? 810 : 0, frozen || flat ? 1190 : 1500);
    options.min_dihedral.reset();
    options.raise_min_dihedral = true;
    expect_bounds(options, frozen || flat ? 810 : 0, frozen || flat ? 1190 : 1500);
    options = options_in(mode);
    options.coarsen = true;
    expect_bounds(options, 0, kCells);
    options.min_cells = 7;
    options.max_cells = 2000;
    expect_bounds(options, 7, 2000);
  }
  ImproveOptions compat;
  compat.compat = Compat::kJpdc2013;
  expect_bounds(compat, 0, 0);
}

TEST(Strategy, AnyCostMakesHalfAsManyCellsAgainUnlessBoundsWereGiven) {
  ImproveOptions options;
  options.raise_min_dihedral = true;
  EXPECT_EQ(resolved(options).any_cost->most_of_hundred, 150U);
  EXPECT_EQ(resolved(options).any_cost->bounds.min, 810U);
  options.max_cells = 1234;
  EXPECT_EQ(resolved(options).any_cost->most_of_hundred, 0U);
  EXPECT_EQ(resolved(options).any_cost->bounds.max, 1234U);
  options = options_in(SurfaceMode::kFlat);
  options.raise_min_dihedral = true;
  EXPECT_EQ(resolved(options).any_cost->most_of_hundred, 0U);
  EXPECT_EQ(resolved(options).any_cost->bounds.max, 1190U);
}

TEST(Strategy, TargetsAscendToTheGoalAndEndWithIt) {
  for (const double goal : {0.5, 15.0, 21.0, 60.0}) {
    ImproveOptions options;
    options.min_dihedral = goal;
    const Strategy strategy = resolved(options);
    ASSERT_TRUE(strategy.goal);
    EXPECT_EQ(strategy.goal->degrees, goal);
    const auto& targets = strategy.targets.targets;
    ASSERT_FALSE(targets.empty());
    EXPECT_EQ(targets.back().degrees, goal);
    for (std::size_t i = 1; i < targets.size(); ++i) EXPECT_LT(targets[i - 1].degrees, targets[i].degrees);
    EXPECT_EQ(strategy.targets.beyond.back().degrees, resolved({}).targets.targets.back().degrees);
  }
  EXPECT_FALSE(resolved({}).goal);
}

TEST(Strategy, StagesThatAreNotToRunAreEmpty) {
  EXPECT_FALSE(resolved({}).untangle);
  EXPECT_TRUE(resolved({}, kTangled).untangle);
  EXPECT_FALSE(resolved({}).coarsen);
  EXPECT_FALSE(resolved({}).any_cost);
  EXPECT_FALSE(resolved({}).volume);
  EXPECT_TRUE(resolved(options_in(SurfaceMode::kFree)).volume);
  EXPECT_TRUE(resolved({}).refine && resolved({}).refine_again);
  EXPECT_FALSE(resolved(options_in(SurfaceMode::kFlat)).refine);
  ImproveOptions limited;
  limited.iterations = 2;
  const Strategy strategy = resolved(limited);
  EXPECT_FALSE(strategy.neighbourhoods);
  EXPECT_FALSE(strategy.patch.enabled);
  EXPECT_FALSE(strategy.refine_again);
  EXPECT_EQ(strategy.bulk.iterations, 2);
  EXPECT_EQ(strategy.polish.iterations, 2);
}

TEST(Strategy, KindsCompeteOnAnglesUnlessAGoalOrTheCallerSaysOtherwise) {
  ImproveOptions options;
  EXPECT_EQ(resolved(options).polish.selection, Selection::kMixedOnAngles);
  EXPECT_EQ(resolved(options).first_polish.polish.selection, Selection::kByKind);
  options.rounds = Rounds::kMixed;
  EXPECT_EQ(resolved(options).first_polish.polish.selection, Selection::kMixed);
  options.rounds = Rounds::kByKind;
  EXPECT_EQ(resolved(options).polish.selection, Selection::kByKind);
  options.rounds = Rounds::kAuto;
  options.min_dihedral = 20;
  EXPECT_EQ(resolved(options).polish.selection, Selection::kByKind);
  options.min_dihedral.reset();
  options.ops = Ops::kEdge | Ops::kSmooth;
  options.rounds = Rounds::kMixed;
  EXPECT_EQ(resolved(options).polish.selection, Selection::kByKind) << "nothing to compete with";
}

TEST(Strategy, TriesOnPatchesHaveNoBoundsAndOneThread) {
  ImproveOptions options;
  options.policy = {4, 1};
  options.max_cells = 10;
  const Strategy patch = strategy_of_patch(resolved(options));
  EXPECT_EQ(patch.pass.policy.threads, 1);
  EXPECT_EQ(patch.bounds.max, 0U);
  EXPECT_EQ(patch.polish.iterations, PatchTrial{}.iterations);
  const Strategy connecting = strategy_to_connect(patch);
  EXPECT_FALSE(has(connecting.pass.ops, Ops::kNode));
  EXPECT_FALSE(has(connecting.pass.ops, Ops::kInsert));
  EXPECT_TRUE(has(connecting.pass.ops, Ops::kEdge));
}

TEST(Strategy, PlacesForVerticesAreLeftEarlyWithAFrozenSurfaceAlone) {
  for (SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat, SurfaceMode::kFree}) {
    const Strategy strategy = resolve(options_in(mode), kValid, kCells);
    EXPECT_EQ(strategy.pass.leaves_early, mode == SurfaceMode::kFrozen);
    EXPECT_EQ(strategy_of_patch(strategy).pass.leaves_early, mode == SurfaceMode::kFrozen);
  }
}

}  // namespace
}  // namespace hfr::test
