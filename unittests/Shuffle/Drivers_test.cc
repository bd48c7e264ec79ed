// SPDX-License-Identifier: BSD-3-Clause
// Every pipeline of improve() under a shuffling scheduler, against the bits of one thread.
#include <gtest/gtest.h>

#include "IO/Hash.hh"
#include "Remesh/Drivers.hh"
#include "Remesh/Meshes.hh"
#include "Shuffle/Seeds.hh"
#include "Shuffle/Shuffle.hh"

namespace hfr::test {
namespace {

constexpr std::uint64_t kSeeds = 200;

std::vector<Driver> drivers() {
  std::vector<Driver> all = courses();
  for (Driver& driver : variations()) all.push_back(std::move(driver));
  for (std::size_t i = 0; i < all.size(); i += 4) all[i].options.statistics = true;
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
