// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_FONT_HH
#define HFR_APPS_REPORT_FONT_HH

#include <string>
#include <string_view>

#include "Canvas.hh"

/// Text on a Canvas, in letters of lines and arcs that are our own: a picture needs no font of the machine,
/// and is the same on each.
namespace hfr::view {

enum class Align { kLeft, kCentre, kRight };

struct TextStyle {
  double size = 18;  ///< units of the canvas from line to line; capitals are 0.7 of it
  Colour colour = {};
  Align align = Align::kLeft;
  bool bold = false;
};

/// Units from the beginning of the text to its end. The text is UTF-8; what has no letter here, which is
/// everything beyond ASCII but the degree sign, is a box.
double text_width(std::string_view text, const TextStyle& style);
/// `x` is where the text begins, has its middle or ends, by style.align; `y` is the line that letters stand
/// on.
void draw_text(Canvas& canvas, double x, double y, std::string_view text, const TextStyle& style);
/// The text with its middle left out, so that it is no wider than so many units.
std::string shortened(std::string_view text, double width, const TextStyle& style);

}  // namespace hfr::view

#endif
