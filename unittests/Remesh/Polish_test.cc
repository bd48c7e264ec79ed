// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Polish.hh"

#include <gtest/gtest.h>

#include <vector>

#include "Remesh/Meshes.hh"
#include "Remesh/StageBench.hh"

namespace hfr::test {
namespace {

struct Polished {
  TetMesh mesh;
  int iterations = 0;
  std::size_t n_left = 0;  ///< cells below the angle
};

/// Without vertices towards 45 degrees, which most cells miss. `may_dig`: as if as many could get some.
Polished polished(std::size_t least_fewer, bool may_dig) {
  Polished result{jittered(10, 0.2, 1)};
  ImproveOptions options = serial();
  options.ops = Ops::kEdge | Ops::kFace | Ops::kSmooth;
  StageBench bench(result.mesh, options);
  PolishEffort effort;
  effort.least_fewer = least_fewer;
  if (may_dig) effort.few_to_dig = result.mesh.n_cells();
  const double degrees = 45;
  polish(bench.run, effort, degrees);
  for (const PassReport& pass : bench.control().passes())
    if (pass.op == "smooth") ++result.iterations;
  result.n_left = n_below(result.mesh, degrees, {});
  return result;
}

std::vector<Vec3> points_of(const TetMesh& mesh) {
  std::vector<Vec3> points;
  for (VertexHandle v : mesh.vertices()) points.push_back(mesh.point(v));
  return points;
}

TEST(Polish, EndsSoonerWhereFewOfTooManyCellsAreMended) {
  const Polished patient = polished(kNoLimit, false), usual = polished(PolishEffort{}.least_fewer, false);
  EXPECT_GT(usual.n_left, usual.mesh.n_cells() / PolishEffort{}.dig_share) << "too many to the end";
  EXPECT_LT(4 * usual.iterations, 3 * patient.iterations);
  EXPECT_LT(10 * usual.n_left, 11 * patient.n_left) << "what was left out has brought next to nothing";
}

TEST(Polish, IsPatientWithNoMoreCellsThanMayGetVertices) {
  const Polished patient = polished(kNoLimit, true), usual = polished(PolishEffort{}.least_fewer, true);
  EXPECT_GT(usual.iterations, 0);
  EXPECT_EQ(usual.iterations, patient.iterations);
  EXPECT_TRUE(points_of(usual.mesh) == points_of(patient.mesh));
}

}  // namespace
}  // namespace hfr::test
