// SPDX-License-Identifier: BSD-3-Clause
// Asking for more never gives less, and a mesh that is poor throughout is no reason to do nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "Remesh/Improve.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/Trial.hh"

namespace hfr::test {
namespace {

/// A grid whose cells are pressed flat along z.
TetMesh pressed(Index n, double jitter, double height) {
  generate::Arrays arrays = generate::jittered_box({n, n, n}, jitter, 7);
  for (Vec3& p : arrays.points) p.z *= height;
  return built(arrays);
}

TetMesh wrung(double degrees) { return built(generate::cylinder(2, 6, 1, 2, 0, degrees)); }

/// Valid ones, poor and good, and some that cannot be mended altogether.
std::vector<TetMesh> meshes() {
  std::vector<TetMesh> all;
  for (std::uint64_t seed = 1; seed <= 2; ++seed)
    for (double jitter : {0.2, 0.35, 0.6}) all.push_back(jittered(4, jitter, seed));
  for (double height : {0.1, 0.05}) all.push_back(pressed(4, 0.2, height));
  for (double degrees : {58.0, 85.0}) all.push_back(wrung(degrees));
  return all;
}

struct Outcome {
  double worst;
  std::size_t n_inverted, n_invalid;
};

Outcome outcome_of(TetMesh mesh, const ImproveOptions& options) {
  const Statistics after = improve(mesh, options).after;
  return {after.min_dihedral.min, after.inverted.size(), after.inverted.size() + after.flat.size()};
}

ImproveOptions towards(double degrees) {
  ImproveOptions options = serial();
  options.min_dihedral = degrees;
  return options;
}

ImproveOptions at_any_cost() {
  ImproveOptions options = serial();
  options.raise_min_dihedral = true;
  return options;
}

TEST(Rules, AskingForMoreNeverLeavesMoreInvalidCellsThanAskingThatTheyBeMended) {
  std::size_t n_invalid_meshes = 0, n_runs = 0;
  for (const TetMesh& mesh : meshes()) {
    const Outcome plain = outcome_of(mesh, towards(0.001));
    if (statistics(mesh, par::Policy{}).inverted.empty()) continue;
    ++n_invalid_meshes;
    for (const ImproveOptions& options : {serial(), towards(15), at_any_cost()}) {
      const Outcome more = outcome_of(mesh, options);
      EXPECT_LE(more.n_inverted, plain.n_inverted);
      EXPECT_LE(more.n_invalid, plain.n_invalid);
      ++n_runs;
    }
  }
  EXPECT_GE(n_invalid_meshes, 4U);
  EXPECT_EQ(n_runs, 3 * n_invalid_meshes);
}

TEST(Rules, RaisingTheWorstAngleAtAnyCostEndsNoLowerThanADefaultRun) {
  std::size_t n_valid = 0;
  for (const TetMesh& mesh : meshes()) {
    const Outcome usual = outcome_of(mesh, serial());
    if (usual.n_invalid > 0) continue;
    ++n_valid;
    EXPECT_GE(outcome_of(mesh, at_any_cost()).worst, usual.worst - kLeastRise);
  }
  EXPECT_GE(n_valid, 4U);
}

TEST(Rules, DefaultRunReachesWhatAGoalReachesThatItClaims) {
  std::size_t n_valid = 0;
  for (const TetMesh& mesh : meshes()) {
    const Outcome usual = outcome_of(mesh, serial());
    // Pressed ones have more than a hundredth of their cells below, for which a default run makes no room.
    if (usual.n_invalid > 0 || statistics(mesh, par::Policy{}).box_high.z < 1) continue;
    ++n_valid;
    EXPECT_GE(usual.worst, std::min(15.0, outcome_of(mesh, towards(15)).worst) - kLeastRise);
  }
  EXPECT_GE(n_valid, 4U);
}

TEST(Rules, MeshThatIsPoorThroughoutIsRaisedByADefaultRun) {
  const TetMesh mesh = pressed(8, 0.2, 0.05);
  ASSERT_LT(statistics(mesh, par::Policy{}).min_dihedral.min, 2);
  EXPECT_GT(outcome_of(mesh, serial()).worst, 5);
}

}  // namespace
}  // namespace hfr::test
