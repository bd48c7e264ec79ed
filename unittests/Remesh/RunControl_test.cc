// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/RunControl.hh"

#include <gtest/gtest.h>

#include <limits>

namespace hfr::test {
namespace {

constexpr double kNoTime = 1e-12;
constexpr double kForEver = std::numeric_limits<double>::infinity();

TEST(RunControl, FirstReasonToStopStays) {
  bool cancelled = false;
  RunControl control(kForEver, [&] { return cancelled; });
  EXPECT_FALSE(control.stopped());
  EXPECT_FALSE(control.reason());
  cancelled = true;
  EXPECT_TRUE(control.stopped());
  cancelled = false;
  EXPECT_TRUE(control.stopped());
  EXPECT_EQ(control.reason(), Stop::kCancelled);
  control.stop(Stop::kTimeLimit);
  EXPECT_EQ(control.reason(), Stop::kCancelled);
}

TEST(RunControl, TimeLimitStops) {
  RunControl control(kNoTime);
  while (control.seconds() <= kNoTime) {
  }
  EXPECT_LT(control.seconds_left(), 0);
  EXPECT_TRUE(control.stopped());
  EXPECT_EQ(control.reason(), Stop::kTimeLimit);
}

TEST(RunControl, FractionNeverGoesBack) {
  RunControl control;
  control.set_fraction(0.4);
  control.set_fraction(0.2);
  EXPECT_EQ(control.fraction(), 0.4);
  control.set_fraction(0.6);
  EXPECT_EQ(control.fraction(), 0.6);
}

TEST(RunControl, UndoTakesBackWhatWasCounted) {
  RunControl control;
  PassReport pass;
  pass.winners = 3;
  control.add(pass);
  const Revision before = control.revision(), first = RunControl().revision();
  EXPECT_FALSE(before == first);
  control.add(pass);
  const Revision after = control.revision();
  EXPECT_EQ(control.n_changes(), 6U);
  control.add_undo(before, 2, -0.5);
  EXPECT_EQ(control.n_changes(), 3U);
  ASSERT_EQ(control.passes().size(), 3U);
  EXPECT_EQ(control.passes().back().op, "undo");
  EXPECT_EQ(control.passes().back().n_inverted, 2U);
  EXPECT_EQ(control.revision(), before);
  control.add({});
  EXPECT_EQ(control.revision(), before) << "nothing was changed";
  control.add(pass);
  EXPECT_EQ(control.n_changes(), after.n_changes);
  EXPECT_FALSE(control.revision() == after) << "another mesh after as many operators";
}

}  // namespace
}  // namespace hfr::test
