// SPDX-License-Identifier: BSD-3-Clause
// ImproveOptions::coarsen.
#include <gtest/gtest.h>

#include <optional>

#include "HalfFace/Check.hh"
#include "IO/Hash.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

ImproveOptions coarsening() {
  ImproveOptions options = serial();
  options.coarsen = true;
  return options;
}

bool has_stage(const Result& result, const char* stage) {
  return std::any_of(result.passes.begin(), result.passes.end(),
                     [&](const PassReport& pass) { return pass.stage == stage; });
}

/// A cylinder with a jumbled inside: 7,776 cells.
TetMesh jumbled() {
  generate::Arrays arrays = generate::cylinder(6, 12);
  generate::jitter_inner(arrays, 0.5, 2);
  return built(arrays);
}

TEST(Coarsen, LeavesFewerCellsAndNoWorseAngle) {
  const TetMesh input = jumbled();
  TetMesh bounded = input;
  const Result kept = improve(bounded, serial());
  EXPECT_FALSE(has_stage(kept, "coarsen"));
  TetMesh mesh = input;
  const Result result = improve(mesh, coarsening());
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(has_stage(result, "coarsen"));
  EXPECT_LT(100 * result.after.cells, 97 * kept.after.cells);
  EXPECT_GT(result.after.min_dihedral.min, kept.after.min_dihedral.min - 0.5);
  EXPECT_NEAR(result.after.volume, result.before.enclosed_volume, 1e-13);
  EXPECT_EQ(frozen_places(mesh), frozen_places(input)) << "the surface is frozen";
}

TEST(Coarsen, KeepsToTheBoundThatIsGiven) {
  const TetMesh input = jumbled();
  ImproveOptions options = coarsening();
  TetMesh free = input;
  const std::size_t unbounded = improve(free, options).after.cells;
  options.min_cells = input.n_cells();
  TetMesh mesh = input;
  EXPECT_GT(improve(mesh, options).after.cells, unbounded + 100) << "swaps alone take away fewer";
}

TEST(Coarsen, EveryNumberOfThreadsGivesTheSameBits) {
  std::optional<std::uint64_t> first;
  for (const int threads : {1, 2, 3, 7}) {
    TetMesh mesh = jumbled();
    ImproveOptions options = coarsening();
    options.policy = {threads, /*serial_below=*/1};
    improve(mesh, options);
    const std::uint64_t hash = io::mesh_hash(mesh);
    if (!first) first = hash;
    EXPECT_EQ(hash, *first) << threads << " threads";
  }
}

}  // namespace
}  // namespace hfr::test
