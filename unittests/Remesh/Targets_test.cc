// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Targets.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "Remesh/Beside.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/StageBench.hh"

namespace hfr::test {
namespace {

/// Cells that get their turn in the dearest pass of insertion towards an angle that 5 % of the cells miss, by
/// insertion alone.
std::size_t most_asked_for(TetMesh mesh) {
  ImproveOptions options = serial();
  options.ops = Ops::kInsert;
  options.max_cells = mesh.n_logical_cells() * 3 / 2;
  StageBench bench(mesh, options);
  const double degrees = statistics(mesh, par::Policy{}).min_dihedral.percentiles[2];
  const std::vector<TargetAngle> targets = {{degrees, 0.1}};
  raise_to_targets(bench.run, targets);
  std::size_t most = 0;
  for (const PassReport& pass : bench.control().passes())
    if (pass.op == "insert") most = std::max(most, pass.seeds);
  return most;
}

TEST(Targets, MeshThatIsPoorThroughoutGetsVerticesForAsManyCellsAsMissTheTarget) {
  generate::Arrays arrays = generate::jittered_box({10, 10, 10}, 0.25, 7);
  const TetMesh good = built(arrays);
  for (Vec3& p : arrays.points) p.z *= 0.05;
  const TetMesh pressed = built(arrays);
  const std::size_t dig_share = PolishEffort{}.dig_share;
  EXPECT_GT(most_asked_for(pressed), 3 * pressed.n_cells() / (2 * dig_share));
  EXPECT_LE(most_asked_for(good), good.n_cells() / dig_share);
}

/// Plates that nothing raises, and that nothing proves to be held, beside a box that most cells of are poor.
TEST(Targets, OneThatMendsNothingEndsThoseAfterItUnlessTheyGoOnPastIt) {
  generate::Arrays arrays = generate::jittered_box({6, 6, 6}, 0.2, 7);
  for (Vec3& p : arrays.points) p.z *= 0.2;
  const TetMesh both = beside_plates(built(arrays), 100);
  constexpr double kPlates = 4, kBox = 15;
  const std::size_t n_plates = n_below(both, kPlates, {}), n_poor = n_below(both, kBox, {});
  ASSERT_GT(n_plates, both.n_cells() / 10);
  ASSERT_GT(n_poor, 2 * n_plates);
  const std::vector<TargetAngle> targets = {{kPlates, 0.1}, {kBox, 0.1}};
  ImproveOptions options = serial();
  options.max_cells = 2 * both.n_cells();
  for (const WhenManyMiss when :
       {WhenManyMiss::kUsual, WhenManyMiss::kWhileItRises, WhenManyMiss::kPastVain}) {
    TetMesh mesh = both;
    StageBench bench(mesh, options);
    raise_to_targets(bench.run, targets, when);
    EXPECT_EQ(n_below(mesh, kPlates, {}), n_plates);
    if (when == WhenManyMiss::kPastVain)
      EXPECT_LT(n_below(mesh, kBox, {}), n_plates + (n_poor - n_plates) / 2);
    else
      EXPECT_EQ(n_below(mesh, kBox, {}), n_poor);
  }
}

/// The first target mends most of those that miss it, but not the worst.
TEST(Targets, OneThatDoesNotRaiseTheWorstAngleIsTheLastWhileItRises) {
  generate::Arrays arrays = generate::jittered_box({6, 6, 6}, 0.2, 7);
  for (Vec3& p : arrays.points) p.z *= 0.2;
  const TetMesh both = beside_plates(built(arrays), 1);
  const double low = statistics(both, par::Policy{}).min_dihedral.percentiles[2], high = 15;
  const std::size_t n_low = n_below(both, low, {}), n_high = n_below(both, high, {});
  ImproveOptions options = serial();
  options.max_cells = 2 * both.n_cells();
  std::vector<std::size_t> left;
  for (const WhenManyMiss when : {WhenManyMiss::kUsual, WhenManyMiss::kWhileItRises}) {
    TetMesh mesh = both;
    StageBench bench(mesh, options);
    raise_to_targets(bench.run, std::vector<TargetAngle>{{low, 0.1}, {high, 0.1}}, when);
    EXPECT_LT(n_below(mesh, low, {}), n_low / 2);
    left.push_back(n_below(mesh, high, {}));
  }
  EXPECT_LT(left[0], n_high / 2);
  EXPECT_GT(left[1], n_high / 2);
}

}  // namespace
}  // namespace hfr::test
