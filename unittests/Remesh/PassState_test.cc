// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/PassState.hh"

#include <gtest/gtest.h>

#include "HalfFace/Errors.hh"
#include "HalfFace/Writer.hh"
#include "Quality/RoundAxle.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/PassRunner.hh"
#include "Remesh/Snapshot.hh"
#include "Remesh/StageBench.hh"

namespace hfr::test {
namespace {

bool checks_links(const StageBench& bench) {
  return PassRunner<MinSine2>(bench.run, MinSine2{}, "test").checks_links();
}

TEST(PassState, LinksAreHeldWherePositiveCellsCoverADirectionTwice) {
  for (const double degrees : {340.0, 500.0}) {
    TetMesh mesh = round_axle(9, degrees, false);
    ASSERT_TRUE(invalid_cells(mesh, {}).empty());
    StageBench bench(mesh, serial());
    EXPECT_EQ(checks_links(bench), degrees > 360) << degrees;
    EXPECT_EQ(bench.findings().is_folded, degrees > 360);
    EXPECT_FALSE(bench.findings().may_cover_twice);
  }
}

TEST(PassState, WhatCellsCoverIsLookedIntoAgainOnceInvertedOnesHaveComeRight) {
  TetMesh mesh = round_axle(9, 340, false);
  StageBench bench(mesh, serial());
  Snapshot unseen(bench.run);
  EXPECT_FALSE(checks_links(bench));
  Snapshot seen(bench.run);

  const Vec3 place = mesh.point(V(5));
  mesh.set_point(V(5), mesh.point(V(3)));
  ASSERT_FALSE(invalid_cells(mesh, {}).empty());
  bench.run.work.forget_qualities();
  EXPECT_TRUE(checks_links(bench));
  EXPECT_TRUE(bench.findings().may_cover_twice);
  mesh.set_point(V(5), place);
  bench.run.work.forget_qualities();
  EXPECT_FALSE(checks_links(bench));
  EXPECT_FALSE(bench.findings().may_cover_twice);

  seen.put_back(bench.run);
  EXPECT_FALSE(bench.findings().may_cover_twice);
  unseen.put_back(bench.run);
  EXPECT_TRUE(bench.findings().may_cover_twice);
}

/// Rules are tested where the last cell has come right, and again in the end where something since may have
/// broken them.
TEST(PassState, WhatHasComeRightIsTestedThereAndThen) {
  TetMesh mesh = round_axle(9, 340, false);
  const Vec3 place = mesh.point(V(5));
  mesh.set_point(V(5), mesh.point(V(3)));
  StageBench bench(mesh, serial());
  Checkpoint checkpoint(mesh, survey(mesh, {}), {});
  checkpoint.may_trust(true);
  bench.run.checkpoint = &checkpoint;
  bench.run.keep(false);
  Snapshot tangled(bench.run);
  EXPECT_TRUE(checks_links(bench));
  EXPECT_FALSE(checkpoint.is_trusted());

  const auto come_right = [&] {
    mesh.set_point(V(5), place);
    bench.run.work.forget_qualities();
    bench.findings().may_cover_twice = true;
    PassReport pass;
    pass.winners = 1;
    bench.control().add(std::move(pass));
    EXPECT_FALSE(checks_links(bench));
  };
  come_right();
  EXPECT_TRUE(checkpoint.is_trusted());
  Snapshot trusted(bench.run);

  bench.run.work.pinched.assign(mesh.n_vertices(), 0);
  EXPECT_FALSE(checks_links(bench));
  EXPECT_FALSE(checkpoint.is_trusted()) << "with a pinched vertex";
  Snapshot distrusted(bench.run);
  bench.run.work.pinched.clear();
  come_right();
  EXPECT_TRUE(checkpoint.is_trusted());
  trusted.put_back(bench.run);
  EXPECT_TRUE(checkpoint.is_trusted());
  distrusted.put_back(bench.run);
  EXPECT_FALSE(checkpoint.is_trusted()) << "of a mesh from before";

  come_right();
  EXPECT_TRUE(checkpoint.is_trusted());
  bench.findings().is_folded = true;
  EXPECT_TRUE(checks_links(bench));
  EXPECT_FALSE(checkpoint.is_trusted()) << "folded";
  bench.findings().is_folded = false;
  come_right();
  tangled.put_back(bench.run);
  EXPECT_FALSE(checkpoint.is_trusted()) << "tangled again";
  TetMesh::Writer(mesh).cell(C(2)).v[1] = mesh.cell(C(2)).v[0];
  EXPECT_THROW(come_right(), InternalError);
}

}  // namespace
}  // namespace hfr::test
