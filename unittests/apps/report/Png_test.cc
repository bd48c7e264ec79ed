// SPDX-License-Identifier: BSD-3-Clause
#include "Png.hh"

#include <gtest/gtest.h>

#include "Angles.hh"
#include "apps/report/Decode.hh"

namespace hfr::app::test {
namespace {

TEST(Png, TheColourOfOnePoorCellSurvivesAmongManyOthers) {
  view::Canvas canvas(300, 300, view::hex(0xffffff));
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 300; ++x)
      canvas.blend(x, y, {static_cast<float>(x) / 300, static_cast<float>(y) / 300, 0.8F}, 1);
  const view::Colour poorest = view::poor_colour(0);
  canvas.blend(7, 5, poorest, 1);
  const Decoded picture = decoded(view::png_of(canvas, view::colours_that_matter()));
  ASSERT_EQ(picture.width, 300U);
  EXPECT_LE(picture.n_colours(0, 300), 256U);
  const std::size_t at = 3 * (5U * 300 + 7);
  EXPECT_NEAR(picture.rgb[at], 255 * poorest.r, 1);
  EXPECT_NEAR(picture.rgb[at + 1], 255 * poorest.g, 1);
  EXPECT_NEAR(picture.rgb[at + 2], 255 * poorest.b, 1);
}

}  // namespace
}  // namespace hfr::app::test
