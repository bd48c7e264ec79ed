// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/RunControl.hh"

#include <gtest/gtest.h>

namespace hfr::test {
namespace {

TEST(RunControl, FirstReasonToStopStays) {
  ImproveOptions options;
  bool cancelled = false;
  options.cancel = [&] { return cancelled; };
  RunControl control(options);
  EXPECT_FALSE(control.stopped());
  EXPECT_FALSE(control.reason());
  cancelled = true;
  EXPECT_TRUE(control.stopped());
  cancelled = false;
  EXPECT_TRUE(control.stopped());
  EXPECT_EQ(control.reason(), Stop::kCancelled);
  options.time_limit = 1e-12;
  EXPECT_TRUE(control.stopped());
  EXPECT_EQ(control.reason(), Stop::kCancelled);
}

TEST(RunControl, TimeLimitStops) {
  ImproveOptions options;
  options.time_limit = 1e-12;
  RunControl control(options);
  while (control.seconds() <= options.time_limit) {
  }
  EXPECT_TRUE(control.stopped());
  EXPECT_EQ(control.reason(), Stop::kTimeLimit);
}

TEST(RunControl, FractionNeverGoesBack) {
  const ImproveOptions options;
  RunControl control(options);
  control.set_fraction(0.4);
  control.set_fraction(0.2);
  EXPECT_EQ(control.fraction(), 0.4);
  control.set_fraction(0.6);
  EXPECT_EQ(control.fraction(), 0.6);
}

}  // namespace
}  // namespace hfr::test
