// SPDX-License-Identifier: BSD-3-Clause
// The order of stages, as docs/pipeline.md has it.
#include "Remesh/Pipeline.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "Remesh/Improve.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

/// Names of the stages in the order of their passes, each once for passes in a row.
std::vector<std::string> stages_of(TetMesh mesh, const ImproveOptions& options) {
  std::vector<std::string> stages;
  for (const PassReport& pass : improve(mesh, options).passes)
    if (stages.empty() || stages.back() != pass.stage) stages.push_back(pass.stage);
  return stages;
}

/// Whether the names stand in that order, each of them.
::testing::AssertionResult in_order(const std::vector<std::string>& stages,
                                    const std::vector<std::string>& wanted) {
  auto at = stages.begin();
  for (const std::string& name : wanted) {
    at = std::find(at, stages.end(), name);
    if (at == stages.end()) {
      auto failure = ::testing::AssertionFailure() << "no stage '" << name << "' there:";
      for (const std::string& stage : stages) failure << ' ' << stage;
      return failure;
    }
  }
  return ::testing::AssertionSuccess();
}

/// A box with a few poor cells, and one with inverted ones.
TetMesh poor() { return jittered(6, 0.3, 2); }
TetMesh tangled() { return jittered(5, 0.6, 3); }

TEST(Pipeline, DefaultRunsMendThenImproveAllThenRaiseTheWorst) {
  EXPECT_TRUE(in_order(stages_of(tangled(), serial()), {"untangle", "bulk", "polish"}));
  EXPECT_FALSE(in_order(stages_of(poor(), serial()), {"untangle"}));
}

TEST(Pipeline, GoalThatFewCellsMissLeavesTheOthersAlone) {
  ImproveOptions options = serial();
  options.min_dihedral = 10;
  const auto stages = stages_of(poor(), options);
  ASSERT_FALSE(stages.empty());
  EXPECT_EQ(stages.front(), "polish");
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "bulk"), 0);
}

TEST(Pipeline, GoalThatManyCellsMissBeginsWithAllCells) {
  ImproveOptions options = serial();
  options.min_dihedral = 40;
  EXPECT_TRUE(in_order(stages_of(poor(), options), {"bulk", "polish"}));
}

TEST(Pipeline, AnyCostSearchesPatchesAfterADefaultRun) {
  ImproveOptions options = serial();
  options.raise_min_dihedral = true;
  EXPECT_TRUE(in_order(stages_of(jittered(3, 0.3, 2), options), {"bulk", "polish", "patches"}));
}

TEST(Pipeline, CoarseningComesBeforeTheBulkStage) {
  ImproveOptions options = serial();
  options.coarsen = true;
  EXPECT_TRUE(in_order(stages_of(poor(), options), {"coarsen", "bulk", "polish"}));
}

TEST(Pipeline, CompatIsThePapersPipelineAlone) {
  ImproveOptions options = serial();
  options.compat = Compat::kJpdc2013;
  EXPECT_EQ(stages_of(tangled(), options), std::vector<std::string>{"jpdc2013"});
}

}  // namespace
}  // namespace hfr::test
