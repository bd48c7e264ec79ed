// SPDX-License-Identifier: BSD-3-Clause
#include "Chart.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "Angles.hh"
#include "Font.hh"

namespace hfr::view {
namespace {

constexpr double kTextSize = 19;
constexpr Colour kBar = hex(0x6f8fb3);

double n_angles(const Statistics& s) {
  const auto& bins = s.dihedral_histogram;
  return static_cast<double>(
      std::max<std::uint64_t>(1, std::accumulate(bins.begin(), bins.end(), std::uint64_t{0})));
}

void draw_scale(Canvas& canvas, const Rectangle& plot) {
  canvas.line(plot.left, plot.bottom, plot.right, plot.bottom, 1.5, kPaleInk);
  for (int degrees = 0; degrees <= 180; degrees += 30) {
    const double x = plot.left + (plot.right - plot.left) * degrees / 180;
    canvas.line(x, plot.bottom, x, plot.bottom + 6, 1.5, kPaleInk);
    draw_text(canvas, x, plot.bottom + 25, fmt::format("{}\u00b0", degrees),
              {.size = kTextSize, .colour = kPaleInk, .align = Align::kCentre});
  }
}

/// "min" and "max" over the histogram, and how many cells are inverted.
void draw_extremes(Canvas& canvas, const Rectangle& where, const Statistics& s) {
  const double y = where.top + kTextSize;
  TextStyle style{.size = 22, .colour = kInk, .align = Align::kLeft, .bold = true};
  const std::string smallest = fmt::format("min {:.2f}\u00b0", s.min_dihedral.min);
  draw_text(canvas, where.left, y, smallest, style);
  if (!s.inverted.empty()) {
    const TextStyle words{.size = kTextSize, .colour = kInvalidColour, .align = Align::kLeft, .bold = true};
    draw_text(canvas, where.left + text_width(smallest, style) + 18, y,
              fmt::format("{} inverted", grouped(s.inverted.size())), words);
  }
  style.align = Align::kRight;
  draw_text(canvas, where.right, y, fmt::format("max {:.2f}\u00b0", s.max_dihedral), style);
}

}  // namespace

std::string grouped(std::size_t n) {
  std::string text = std::to_string(n);
  for (std::size_t i = text.size(); i > 3;) text.insert(i -= 3, 1, ',');
  return text;
}

double highest_share(const Statistics& s) {
  const auto& bins = s.dihedral_histogram;
  return static_cast<double>(*std::max_element(bins.begin(), bins.end())) / n_angles(s);
}

void draw_histogram(Canvas& canvas, Rectangle where, const Statistics& s, double highest) {
  constexpr double kAbove = 38, kBelow = 34, kGap = 1.5, kLeast = 2;  // pixels
  const Rectangle plot = {where.left + 12, where.top + kAbove, where.right - 12, where.bottom - kBelow};
  const auto& bins = s.dihedral_histogram;
  const double width = (plot.right - plot.left) / static_cast<double>(bins.size());
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (bins[i] == 0) continue;
    const double share = static_cast<double>(bins[i]) / n_angles(s);
    // What is there at all is seen.
    const double height = std::max(kLeast, share / std::max(highest, 1e-9) * (plot.bottom - plot.top));
    const double x = plot.left + width * static_cast<double>(i);
    const double middle = 5.0 * static_cast<double>(i) + 2.5;
    canvas.rectangle(x + kGap / 2, plot.bottom - height, x + width - kGap / 2, plot.bottom,
                     cell_colour(middle, kBar));
  }
  draw_scale(canvas, plot);
  draw_extremes(canvas, where, s);
}

void draw_legend(Canvas& canvas, double x, double y) {
  constexpr double kBarWidth = 240, kHigh = 16, kGap = 12;
  const TextStyle style{.size = kTextSize, .colour = kPaleInk};
  const std::string smallest = "smallest dihedral of a cell", inverted = "inverted or flat";
  const std::string zero = "0\u00b0", poor = fmt::format("{:g}\u00b0", kPoorBelow);
  const double total = text_width(smallest, style) + text_width(zero, style) + text_width(poor, style) +
                       text_width(inverted, style) + kBarWidth + kHigh + 6 * kGap;
  const double base = y + 0.3 * kTextSize;
  double at = std::floor(x - 0.5 * total);
  const auto put = [&](const std::string& text) {
    draw_text(canvas, at, base, text, style);
    at = std::floor(at + text_width(text, style) + kGap);
  };
  put(smallest);
  at += kGap;
  put(zero);
  // Each over the rest of the bar, so that no paper shows where pixels are covered in part.
  for (int i = 0; i < static_cast<int>(kBarWidth); ++i)
    canvas.rectangle(at + i, y - kHigh / 2, at + kBarWidth, y + kHigh / 2,
                     poor_colour(kPoorBelow * i / kBarWidth));
  at += kBarWidth + kGap;
  put(poor);
  at += kGap;
  canvas.rectangle(at, y - kHigh / 2, at + kHigh, y + kHigh / 2, kInvalidColour);
  at += kHigh + kGap;
  put(inverted);
}

}  // namespace hfr::view
