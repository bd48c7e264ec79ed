// SPDX-License-Identifier: BSD-3-Clause
// Limits, progress, cancel and bad options of improve().
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "HalfFace/Reorder.hh"
#include "IO/Hash.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

TEST(ImproveOptions, BadOptionsAreRefusedWithOneClearLineAndTheMeshUntouched) {
  const auto expect_refused = [](const auto& spoil, const char* part) {
    TetMesh mesh = jittered(3, 0.3, 1);
    const std::uint64_t hash = io::mesh_hash(mesh);
    ImproveOptions options = serial();
    spoil(options);
    try {
      improve(mesh, options);
      ADD_FAILURE() << "accepted: " << part;
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(part));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
    EXPECT_EQ(io::mesh_hash(mesh), hash);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double degrees : {0.0, -5.0, 70.5, 180.0, kNan})
    expect_refused([&](ImproveOptions& o) { o.min_dihedral = degrees; }, "dihedral");
  expect_refused([](ImproveOptions& o) { o.iterations = -1; }, "iterations");
  for (const double seconds : {0.0, -1.0, kNan})
    expect_refused([&](ImproveOptions& o) { o.time_limit = seconds; }, "time limit");
  expect_refused([](ImproveOptions& o) { o.ops = Ops::kNone; }, "operator");
  for (const int threads : {0, -3})
    expect_refused([&](ImproveOptions& o) { o.policy.threads = threads; }, "threads");
}

#ifdef HFR_HAS_SURFACE
// Such a mesh is put into another order for a run, before its surface is looked at.
TEST(ImproveOptions, BadOptionsOfTheSurfaceLeaveTheOrderOfScatteredCells) {
  const generate::Arrays arrays = generate::jittered_box({20, 20, 20}, 0.2, 3);
  std::vector<std::array<Index, 4>> cells(arrays.cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i * 23017 % cells.size()] = arrays.cells[i];
  TetMesh mesh = build(arrays.points, cells);
  ASSERT_TRUE(is_scattered(mesh));
  const std::uint64_t hash = io::mesh_hash(mesh);
  ImproveOptions options = serial();
  options.surface.mode = SurfaceMode::kFree;
  options.surface.hausdorff = -1;
  EXPECT_THROW(improve(mesh, options), InvalidInput);
  EXPECT_EQ(io::mesh_hash(mesh), hash);
}
#endif

TEST(ImproveOptions, IterationLimitHolds) {
  for (const bool with_goal : {false, true}) {
    TetMesh mesh = jittered(7, 0.3, 2);
    ImproveOptions options = serial();
    options.iterations = 1;
    if (with_goal) options.min_dihedral = 40;
    const Result result = improve(mesh, options);
    ASSERT_FALSE(result.passes.empty());
    for (const PassReport& pass : result.passes)
      EXPECT_TRUE(pass.iteration == 1 || pass.stage == "untangle") << pass.stage;
    EXPECT_EQ(check(mesh), Ok);
  }
}

TEST(ImproveOptions, TinyTimeLimitLeavesAValidMesh) {
  for (const double seconds : {1e-9, 0.005, 0.02}) {
    TetMesh mesh = small_cavity();
    const auto boundary = boundary_of(mesh);
    const double before = worst_quality(mesh, VolumeLength{});
    ImproveOptions options = serial();
    options.time_limit = seconds;
    options.statistics = false;
    const Result result = improve(mesh, options);
    EXPECT_EQ(result.stop, Stop::kTimeLimit);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_TRUE(boundary_of(mesh) == boundary);
    EXPECT_GE(worst_quality(mesh, VolumeLength{}), before);
    EXPECT_EQ(result.invalid_cells.empty(), n_inverted(mesh) == 0);
    expect_dense(mesh);
    EXPECT_FALSE(seconds < 1e-6 && result.changed);
  }
}

TEST(ImproveOptions, CancelAfterTheFirstPassStopsThere) {
  TetMesh mesh = small_cavity();
  const double before = volume(mesh);
  ImproveOptions options = serial();
  int passes = 0;
  options.progress = [&](const Progress&) { ++passes; };
  options.cancel = [&] { return passes > 0; };
  const Result result = improve(mesh, options);
  EXPECT_EQ(result.stop, Stop::kCancelled);
  EXPECT_FALSE(result.goal_reached && result.passes.empty());
  std::size_t worked = 0;
  for (const PassReport& pass : result.passes) worked += pass.winners > 0 ? 1 : 0;
  EXPECT_LE(worked, 1U);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_NEAR(volume(mesh), before, 1e-12);
  expect_dense(mesh);
}

TEST(ImproveOptions, ProgressTellsStageAndFractionAndNeverGoesBack) {
  TetMesh mesh = small_cavity(8);
  ImproveOptions options = serial();
  double fraction = 0;
  std::size_t calls = 0;
  std::set<std::string> stages;
  options.progress = [&](const Progress& progress) {
    ++calls;
    stages.insert(progress.stage);
    EXPECT_GE(progress.fraction, fraction);
    EXPECT_LE(progress.fraction, 1);
    EXPECT_GE(progress.iteration, 1);
    EXPECT_LT(progress.min_dihedral, 70.6);
    fraction = progress.fraction;
  };
  const Result result = improve(mesh, options);
  EXPECT_EQ(calls, result.passes.size());
  EXPECT_TRUE(stages.contains("untangle"));
  EXPECT_TRUE(stages.contains("bulk"));
  EXPECT_GT(fraction, 0.1);
}

TEST(ImproveOptions, StatisticsAreLeftOutWhenNotWanted) {
  TetMesh mesh = jittered(4, 0.3, 3);
  ImproveOptions options = serial();
  options.statistics = false;
  const Result result = improve(mesh, options);
  EXPECT_TRUE(result.changed);
  EXPECT_EQ(result.before.cells, 0U);
  EXPECT_EQ(result.after.cells, 0U);
}

TEST(ImproveOptions, SeedChangesTheWayButNotTheGoal) {
  std::set<std::uint64_t> hashes;
  for (const std::uint64_t seed : {1, 2, 3}) {
    TetMesh mesh = small_cavity(8);
    ImproveOptions options = serial();
    options.seed = seed;
    EXPECT_TRUE(improve(mesh, options).goal_reached);
    hashes.insert(io::mesh_hash(mesh));
  }
  EXPECT_GT(hashes.size(), 1U);
}

}  // namespace
}  // namespace hfr::test
