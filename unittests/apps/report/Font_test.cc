// SPDX-License-Identifier: BSD-3-Clause
#include "Font.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace hfr::app::test {
namespace {

TEST(Font, EveryLetterOfAsciiLeavesAMarkOfItsOwn) {
  std::set<std::vector<std::uint8_t>> seen;
  for (char c = '!'; c <= '~'; ++c) {
    view::Canvas canvas(40, 40, view::hex(0xffffff));
    view::draw_text(canvas, 10, 28, std::string(1, c), {.size = 24});
    EXPECT_TRUE(seen.insert(canvas.rgb()).second) << c;
  }
  EXPECT_EQ(seen.size(), 94U);
}

TEST(Font, ATextThatIsTooWideLosesItsMiddle) {
  const view::TextStyle style{.size = 20};
  const std::string cut = view::shortened("a-rather-long-name-of-a-mesh-\u00b0.vtu", 150, style);
  EXPECT_LE(view::text_width(cut, style), 150);
  EXPECT_THAT(cut, ::testing::StartsWith("a-r"));
  EXPECT_THAT(cut, ::testing::EndsWith(".vtu"));
  EXPECT_EQ(view::shortened("short.vtu", 150, style), "short.vtu");
}

}  // namespace
}  // namespace hfr::app::test
