// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Targets.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

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

}  // namespace
}  // namespace hfr::test
