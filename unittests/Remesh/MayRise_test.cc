// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/MayRise.hh"

#include <gtest/gtest.h>

#include "Remesh/Beside.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/StageBench.hh"
#include "Remesh/StuckCells.hh"

namespace hfr::test {
namespace {

TEST(MayRise, TheWorstThatMayRiseIsFoundBehindAnyNumberOfCellsThatAreHeld) {
  TetMesh box = jittered(4, 0.2, 1);
  const double worst = StageBench(box, serial()).run.smallest_dihedral();
  ASSERT_GT(worst, 2);
  ASSERT_LT(worst, 20);
  for (const Index n : {0U, 1U, 63U, 64U, 65U, 130U, 700U}) {
    TetMesh mesh = n > 0 ? beside_slivers(box, n) : box;
    const StageBench bench(mesh, serial());
    EXPECT_EQ(smallest_that_may_rise(bench.run, 20), worst) << n;
    EXPECT_EQ(n_at_ceiling(bench.run, 1.5), n);
    EXPECT_EQ(smallest_that_may_rise(bench.run, 1.5), 1.5) << n;  // no other is below
    EXPECT_EQ(cells_that_may_rise(bench.run, worst + 1e-6).size(), 1U) << n;
  }
}

}  // namespace
}  // namespace hfr::test
