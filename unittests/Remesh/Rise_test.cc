// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Rise.hh"

#include <gtest/gtest.h>

#include "Quality/Metric.hh"
#include "Remesh/Strategy.hh"

namespace hfr {
namespace {

TEST(Rise, AnglesRiseByTheFactorBeyondThePlainGoal) {
  EXPECT_EQ(angle_to_rise(10, 1.02, 15), 10 * 1.02);
  EXPECT_EQ(angle_to_rise(1e-15, 1.02, 15), kPlainGoal) << "a hundredfold is flat all the same";
  EXPECT_EQ(angle_to_rise(1e-15, 1.02, kPlainGoal), 1e-15 * 1.02);
  EXPECT_EQ(angle_to_rise(-3, 1.02, 15), -3);
}

TEST(Rise, ValuesOfFlatCellsHaveToComeBeyondThePlainGoal) {
  const double flat = dihedral_decision(kPlainGoal), wanted = dihedral_decision(15);
  EXPECT_EQ(value_to_rise(1e-32, 1.01, wanted), flat);
  EXPECT_EQ(value_to_rise(flat, 1.01, wanted), 1.01 * flat);
  EXPECT_EQ(value_to_rise(0.1, 1.01, wanted), 1.01 * 0.1);
}

TEST(Rise, ValuesRiseByTheFactorAloneWhereNoMoreIsWantedThanThat) {
  EXPECT_EQ(value_to_rise(1e-32, 1.01, dihedral_decision(kPlainGoal)), 1.01 * 1e-32);
}

TEST(Rise, WithAFactorOfOneAnyRiseOfAValueCounts) {
  EXPECT_EQ(value_to_rise(1e-32, 1, dihedral_decision(15)), 1e-32);
}

TEST(Rise, AmongInvertedCellsAnythingIsARise) {
  EXPECT_EQ(value_to_rise(-0.5, 1.01, dihedral_decision(15)), -0.5);
  EXPECT_EQ(value_to_rise(0, 1.01, dihedral_decision(15)), 0);
}

}  // namespace
}  // namespace hfr
