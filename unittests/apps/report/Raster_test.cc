// SPDX-License-Identifier: BSD-3-Clause
#include "Raster.hh"

#include <gtest/gtest.h>

namespace hfr::app::test {
namespace {

TEST(Raster, TheNearerTriangleIsSeenWhicheverIsDrawnFirst) {
  using Corners = std::array<std::array<double, 3>, 3>;
  const Corners near = {{{0, 0, 2}, {20, 0, 2}, {0, 20, 2}}}, far = {{{0, 0, 1}, {20, 0, 1}, {0, 20, 1}}};
  const view::Colour red = view::hex(0xff0000), blue = view::hex(0x0000ff);
  for (const bool near_first : {true, false}) {
    view::Raster raster(20, 20);
    raster.triangle(near_first ? near : far, near_first ? red : blue, {});
    raster.triangle(near_first ? far : near, near_first ? blue : red, {});
    view::Canvas canvas(20, 20, view::hex(0xffffff));
    raster.resolve(canvas, 0, 0);
    EXPECT_EQ(canvas.at(4, 4).r, 1.0F);
    EXPECT_EQ(canvas.at(4, 4).b, 0.0F);
    EXPECT_EQ(canvas.at(15, 15).g, 1.0F);  // beyond the slanted edge
    const float on_edge = canvas.at(10, 9).g;
    EXPECT_GT(on_edge, 0.0F);  // anti-aliased
    EXPECT_LT(on_edge, 1.0F);
  }
}

}  // namespace
}  // namespace hfr::app::test
