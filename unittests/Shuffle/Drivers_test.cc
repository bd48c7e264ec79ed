// SPDX-License-Identifier: BSD-3-Clause
// Every pipeline of improve() under a shuffling scheduler, against the bits of one thread.
#include <gtest/gtest.h>

#include "IO/Hash.hh"
#include "Remesh/Meshes.hh"
#include "Shuffle/Seeds.hh"
#include "Shuffle/Shuffle.hh"
#include "hfremesh/HalfFace/Config.hh"

namespace hfr::test {
namespace {

constexpr std::uint64_t kSeeds = 200;

struct Driver {
  const char* name;
  ImproveOptions options;
};

std::vector<Driver> drivers() {
  std::vector<Driver> all;
  const auto add = [&](const char* name) -> ImproveOptions& {
    all.push_back({name, {}});
    all.back().options.statistics = all.size() % 4 == 1;
    return all.back().options;
  };
  add("default");
  add("goal").min_dihedral = 25;
  add("high goal").min_dihedral = 45;
  ImproveOptions& most = add("max");
  most.raise_min_dihedral = true;
  most.iterations = 3;
  add("bulk nodes").bulk_nodes = true;
  add("coarsen").coarsen = true;
  add("paper").compat = Compat::kJpdc2013;
  ImproveOptions& inserting = add("paper with insertion");
  inserting.compat = Compat::kJpdc2013;
  inserting.ops = Ops::kDefault | Ops::kInsert;
  add("kinds in turn").rounds = Rounds::kByKind;
  add("kinds mixed").rounds = Rounds::kMixed;
  add("candidates").smoother = Smoother::kCandidates;
  add("Laplacian").smoother = Smoother::kLaplacian;
  add("Taubin").smoother = Smoother::kTaubin;
  add("radius ratio").metric = Metric::kRadiusRatio;
  ImproveOptions& cluster = add("cluster search");
  cluster.ops = Ops::kDefault | Ops::kCluster;
  cluster.min_dihedral = 30;
#ifdef HFR_SURFACE
  add("flat").surface.mode = SurfaceMode::kFlat;
  ImproveOptions& flat_goal = add("flat with a goal");
  flat_goal.surface.mode = SurfaceMode::kFlat;
  flat_goal.min_dihedral = 30;
  add("free").surface.mode = SurfaceMode::kFree;
  ImproveOptions& free_goal = add("free with a goal");
  free_goal.surface.mode = SurfaceMode::kFree;
  free_goal.min_dihedral = 25;
  ImproveOptions& free_coarse = add("free, coarsen");
  free_coarse.surface.mode = SurfaceMode::kFree;
  free_coarse.coarsen = true;
#endif
  return all;
}

/// What a result says that does not depend on clocks, or on how many sub-rounds a selection took.
std::string story(const Result& result) {
  std::string all = std::to_string(static_cast<int>(result.stop)) + (result.goal_reached ? " goal" : "");
  for (const PassReport& pass : result.passes) {
    all += "\n" + pass.stage + " " + pass.op;
    for (const std::size_t n : {static_cast<std::size_t>(pass.iteration), pass.rounds, pass.seeds,
                                pass.candidates, pass.winners, pass.n_inverted})
      all += " " + std::to_string(n);
  }
  for (const StuckCell& cell : result.stuck)
    all += "\n" + std::to_string(cell.cell.idx()) + " " +
           kStuckReasonNames[static_cast<std::size_t>(cell.reason)];
  return all;
}

/// A share of the seeds each, so that the shares can run at the same time.
class ShuffledDrivers : public testing::TestWithParam<std::uint64_t> {};
constexpr std::uint64_t kShares = 4;
INSTANTIATE_TEST_SUITE_P(Share, ShuffledDrivers, testing::Range(std::uint64_t{0}, kShares));

TEST_P(ShuffledDrivers, EveryPipelineGivesTheBitsOfOneThread) {
  const std::vector<Driver> all = drivers();
  std::vector<std::size_t> n_changed(all.size(), 0);
  std::size_t n_switched = 0;
  for_seeds(kSeeds, [&](std::uint64_t seed) {
    if (seed % kShares != GetParam()) return;
    Engine engine(seed);
    const std::size_t which = seed % all.size();
    ImproveOptions options = all[which].options;
    SCOPED_TRACE(all[which].name);
    const auto kind = engine() % (static_cast<std::uint64_t>(Limit::kLimits) + 1);
    TetMesh one = kind == static_cast<std::uint64_t>(Limit::kLimits)
                      ? labelled_box(3, 0.35, seed)
                      : limit_mesh(static_cast<Limit>(kind), engine);
    TetMesh many = one;
    options.seed = seed;
    options.policy = kOneThread;
    const Result expected = improve(one, options);
    options.policy = policy_of(engine);
    shuffle(seed);
    const Result found = improve(many, options);
    ASSERT_TRUE(identical(one, many));
    ASSERT_EQ(io::mesh_hash(one), io::mesh_hash(many));
    ASSERT_EQ(story(expected), story(found));
    n_changed[which] += expected.changed ? 1 : 0;
    n_switched += n_switches() > 0 ? 1 : 0;
  });
  if (HasFatalFailure() || !counts_what_it_met(kSeeds)) return;
  std::size_t n_working = 0;
  for (const std::size_t n : n_changed) n_working += n > 1 ? 1 : 0;
  EXPECT_GE(n_working, all.size() / kShares) << "of the drivers that this share has";
  EXPECT_GT(n_switched, kSeeds / kShares / 2);
}

}  // namespace
}  // namespace hfr::test
