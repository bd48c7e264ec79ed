// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/PassState.hh"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hfr::test
