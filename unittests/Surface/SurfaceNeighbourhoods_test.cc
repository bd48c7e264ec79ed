// SPDX-License-Identifier: BSD-3-Clause
// improve_neighbourhoods() where the surface may change.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "HalfFace/Check.hh"
#include "Remesh/Neighbourhoods.hh"
#include "Remesh/StageBench.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

/// Most cells that an insertion pass round the last cells begins with.
std::size_t most_insertion_seeds(TetMesh mesh, SurfaceMode mode) {
  const ImproveOptions options = mode == SurfaceMode::kFrozen ? serial() : with(mode);
  std::optional<SurfaceMesh> surface;
  if (mode != SurfaceMode::kFrozen) surface.emplace(mesh, options.surface, options.policy);
  StageBench bench(mesh, options, surface ? &*surface : nullptr);
  const double degrees = degrees_with_few_below(mesh, 60, NeighbourhoodEffort{}.few, options.policy);
  improve_neighbourhoods(bench.run, bench.run.strategy.neighbourhoods, degrees);
  EXPECT_EQ(check(mesh), Ok);
  std::size_t most = 0;
  for (const PassReport& pass : bench.control().passes())
    if (pass.op == "insert") most = std::max(most, pass.seeds);
  return most;
}

TEST(SurfaceNeighbourhoods, WhereManyAreAlmostAsPoorFreeInsertsNothing) {
  // All cells are alike but for a few: where a dozen are poor, hundreds are within two degrees of them.
  const TetMesh mesh = jittered(12, 0.03, 1);
  const double goal = degrees_with_few_below(mesh, 60, NeighbourhoodEffort{}.few, {});
  ASSERT_GT(n_below(mesh, goal + 2.5, {}), 300U) << "the others are not almost as poor";
  EXPECT_GT(most_insertion_seeds(mesh, SurfaceMode::kFlat), 50U);
  EXPECT_EQ(most_insertion_seeds(mesh, SurfaceMode::kFree), 0U);
}

}  // namespace
}  // namespace hfr::test
