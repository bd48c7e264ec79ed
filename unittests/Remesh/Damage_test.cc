// SPDX-License-Identifier: BSD-3-Clause
// Meshes that are neither valid nor manifold: what a run does to them is written in a form that can be read
// again, and does not damage them more.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "IO/Assemble.hh"
#include "IO/MeshFile.hh"
#include "Quality/Damage.hh"
#include "Remesh/DamagedMeshes.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

Damage damage_of(const TetMesh& mesh) {
  Damage damage;
  for (CellHandle c : mesh.cells()) damage.add(mesh, c);
  return damage;
}

/// Rules that the file of a mesh must keep, for it to be read again.
CheckResult kernel_rules(const TetMesh& mesh) { return check(mesh, {.last = Rule::kDuplicateEdge}); }

void expect_no_more_damage(TetMesh mesh, const ImproveOptions& options) {
  const Damage before = damage_of(mesh);
  ASSERT_GT(before.n_invalid(), 0);
  improve(mesh, options);
  const Damage after = damage_of(mesh);
  EXPECT_EQ(kernel_rules(mesh), Ok);
  EXPECT_LE(after.n_inverted(), before.n_inverted());
  EXPECT_LE(after.n_invalid(), before.n_invalid());
}

TEST(Damage, PartsThatMeetInVerticesGetNoFaceOfThreeCells) {
  expect_no_more_damage(parts_at_vertices(), serial());
  expect_no_more_damage(tangle_of_parts(), serial());
}

TEST(Damage, ElevenCellsThatMeetInVerticesGetNoFaceOfThreeCells) {
  ImproveOptions options = serial();
  options.iterations = 3;
  expect_no_more_damage(eleven_cells(), options);
}

TEST(Damage, AnglesOfAClusterMayFallToTheFloorAndNotBelow) {
  const auto inverted = [](double height, double size) {
    Damage damage;
    damage.add({0, 0, 0}, {0, size, 0}, {size, 0, 0}, {size / 3, size / 3, size * height});
    return damage;
  };
  const Damage before = inverted(0.2, 1);
  const Damage steeper = inverted(0.5, 0.2);  // less overlap, worse angles
  ASSERT_LT(steeper.worst(), before.worst());
  const double between = (steeper.worst() + before.worst()) / 2;
  EXPECT_TRUE(before.may_become(steeper, kNoFloor));
  EXPECT_TRUE(before.may_become(steeper, steeper.worst()));
  EXPECT_FALSE(before.may_become(steeper, between));
  EXPECT_FALSE(before.may_become(steeper, before.worst()));
  const double above_both = before.worst() / 2;
  EXPECT_FALSE(before.may_become(steeper, above_both));
  EXPECT_TRUE(before.may_become(inverted(0.19, 1), above_both)) << "below the floor it may rise";
}

TEST(Damage, FlatCellsAreNotMendedByInvertingOthers) { expect_no_more_damage(inverted_and_flat(), serial()); }

TEST(Damage, InvertedCellsDoNotBecomeMoreInAMetricOfRadii) {
  ImproveOptions options = serial();
  options.metric = Metric::kRadiusRatio;
  options.min_dihedral = 15;
  expect_no_more_damage(flat_and_overlapping(), options);
}

#ifdef HFR_HAS_SURFACE
TEST(Damage, InvertedCellsDoNotBecomeMoreWhereTheSurfaceIsFree) {
  ImproveOptions options = serial();
  options.surface.mode = SurfaceMode::kFree;
  expect_no_more_damage(regions_with_flat_cells(), options);
}
#endif

TEST(Damage, FlatMeshesGainNoInvertedCells) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TetMesh mesh = jittered(3, 0.3, seed);
    for (VertexHandle v : mesh.vertices()) {
      const Vec3 p = {std::round(64 * mesh.point(v).x), std::round(64 * mesh.point(v).y), 0};
      mesh.set_point(v, {p.x, p.y, p.x + 2 * p.y});  // whole numbers: flat to the last bit
    }
    ASSERT_EQ(damage_of(mesh).n_inverted(), 0);
    expect_no_more_damage(mesh, serial());
  }
}

TEST(Damage, TangledBoxesKeepTheRulesInEveryMode) {
  int n_damaged = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    for (const Metric metric : {Metric::kVolumeLength, Metric::kMinDihedral, Metric::kScaledJacobian}) {
      TetMesh mesh = jittered(3, 0.6 + 0.1 * static_cast<double>(seed % 4), seed);
      if (damage_of(mesh).n_invalid() == 0) continue;
      ++n_damaged;
      ImproveOptions options = serial();
      options.metric = metric;
      if (seed % 2 == 0) options.compat = Compat::kJpdc2013;
      expect_no_more_damage(mesh, options);
    }
  }
  EXPECT_GT(n_damaged, 15);
}

struct Repro {
  const char* name;
  void (*set)(ImproveOptions&);
};

class DamagedFiles : public testing::TestWithParam<Repro> {};

TEST_P(DamagedFiles, AreWrittenSoThatTheyCanBeReadAgainAndNoMoreDamaged) {
  const auto path = std::filesystem::path(HFR_TEST_MESHES).parent_path() / "repro" / GetParam().name;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  ImproveOptions options = serial();
  GetParam().set(options);
  expect_no_more_damage(io::assemble(io::read_mesh(path.string())), options);
}

INSTANTIATE_TEST_SUITE_P(Repro, DamagedFiles,
                         testing::Values(Repro{"case1962.vtu", [](ImproveOptions&) {}},
                                         Repro{"case2533.vtu", [](ImproveOptions&) {}},
                                         Repro{"case100603.vtu", [](ImproveOptions& o) { o.iterations = 3; }},
                                         Repro{"case300013.vtu", [](ImproveOptions&) {}},
                                         Repro{"case1153.vtu",
                                               [](ImproveOptions& o) {
                                                 o.metric = Metric::kRadiusRatio;
                                                 o.min_dihedral = 15;
                                               }},
                                         Repro{"case121.vtu", [](ImproveOptions&) {}}));

}  // namespace
}  // namespace hfr::test
