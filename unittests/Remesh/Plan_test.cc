// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "HalfFace/Errors.hh"
#include "IO/Hash.hh"
#include "Remesh/Improve.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

/// Whether the texts stand in the plan in that order.
::testing::AssertionResult says(const std::string& plan, const std::vector<std::string>& wanted) {
  std::size_t at = 0;
  for (const std::string& text : wanted) {
    at = plan.find(text, at);
    if (at == std::string::npos)
      return ::testing::AssertionFailure() << "'" << text << "' is not there, or too early:\n" << plan;
  }
  return ::testing::AssertionSuccess();
}

TEST(Plan, NamesStagesInTheirOrderAndLeavesTheMeshAsItIs) {
  const TetMesh mesh = jittered(5, 0.6, 3);
  const std::uint64_t before = io::mesh_hash(mesh);
  const std::string text = plan(mesh, serial());
  EXPECT_TRUE(says(text, {"default", "edge,face,node,smooth,insert", "untangle", "first polish", "bulk",
                          "refine", "targets", "refine again", "last cells"}));
  EXPECT_EQ(io::mesh_hash(mesh), before);
  EXPECT_FALSE(says(plan(jittered(4, 0.1, 1), serial()), {"untangle"})) << "nothing is inverted there";
}

TEST(Plan, HasTheNumbersOfTheOptions) {
  const TetMesh mesh = jittered(5, 0.2, 1);
  ImproveOptions options = serial();
  options.min_dihedral = 21.5;
  options.max_cells = 1234;
  options.ops = Ops::kEdge | Ops::kSmooth;
  EXPECT_TRUE(says(plan(mesh, options), {"goal", "edge,smooth", "above 1234 cells", "21.5"}));
  options = serial();
  options.raise_min_dihedral = true;
  EXPECT_TRUE(
      says(plan(mesh, options), {"any cost", "last cells", "150 of 100 cells", "42.5 (from 30), 45"}));
  options = serial();
  options.compat = Compat::kJpdc2013;
  options.iterations = 7;
  EXPECT_TRUE(says(plan(mesh, options), {"jpdc2013", "7 iterations"}));
}

TEST(Plan, NamesWhatGoesOnBelowTheClaimAndWhatWasLeftOut) {
  const TetMesh mesh = jittered(4, 0.2, 1);
  ImproveOptions options = serial();
  EXPECT_TRUE(
      says(plan(mesh, options),
           {"only if the one before", "claimed", "the bound on cells was in the way", "times 1.5 as many",
            "from the start", "the run towards 15 degrees", "others", "the targets up to that"}));
  EXPECT_FALSE(says(plan(mesh, options), {"left out"}));
  options.max_cells = 1000;
  EXPECT_TRUE(says(plan(mesh, options), {"claimed", "above 1000 cells", "others"}));
  EXPECT_FALSE(says(plan(mesh, options), {"as many"}));
  options = serial();
  options.min_dihedral = 12;
  EXPECT_TRUE(says(plan(mesh, options), {"claimed", "below 12 degrees", "others"}));
  EXPECT_FALSE(says(plan(mesh, options), {"from the start"}));
  options.surface.mode = SurfaceMode::kFlat;
  EXPECT_TRUE(says(plan(mesh, options),
                   {"not before the end of the run", "claimed", "others",
                    "from the first on that so many miss", "from the start", "the run without a goal"}));
  EXPECT_FALSE(says(plan(mesh, options), {"where the first is beyond"})) << "there is none beyond 12 degrees";
  options.min_dihedral.reset();
  options.surface.mode = SurfaceMode::kFree;
  EXPECT_TRUE(
      says(plan(mesh, options), {"more than 35 %", "claimed", "frozen", "from the start",
                                 "the run with a flat surface", "others", "where the first is beyond"}));
  options.iterations = 1;
  EXPECT_TRUE(says(plan(mesh, options), {"of the cells are below, not at all"}));
  EXPECT_FALSE(says(plan(mesh, options), {"claimed"}));
}

TEST(Plan, RefusesOptionsThatARunRefuses) {
  ImproveOptions options = serial();
  options.min_dihedral = 71;
  EXPECT_THROW(static_cast<void>(plan(bipyramid(0.2), options)), InvalidInput);
}

}  // namespace
}  // namespace hfr::test
