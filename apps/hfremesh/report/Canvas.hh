// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_CANVAS_HH
#define HFR_APPS_REPORT_CANVAS_HH

#include <cstdint>
#include <vector>

/// A sheet of pixels to draw on without a display: rectangles, lines and, in Font.hh, text, all anti-aliased.
namespace hfr::view {

/// Red, green, blue from 0 to 1, as a screen takes them (sRGB).
struct Colour {
  float r = 0, g = 0, b = 0;
};
Colour mix(Colour a, Colour b, float share_of_b);
/// 0xRRGGBB.
constexpr Colour hex(std::uint32_t rgb) {
  return {static_cast<float>(rgb >> 16 & 255) / 255, static_cast<float>(rgb >> 8 & 255) / 255,
          static_cast<float>(rgb & 255) / 255};
}

/// Pixels from (0, 0) at the upper left. What is drawn has coordinates in units of so many pixels each
/// (`scale`), and (0.5, 0.5) is the middle of the first unit.
class Canvas {
 public:
  /// Sizes are in units.
  Canvas(double width, double height, Colour background, double scale = 1);

  int width() const { return width_; }    ///< in pixels
  int height() const { return height_; }  ///< in pixels
  double scale() const { return scale_; }
  Colour at(int x, int y) const { return pixels_[index(x, y)]; }
  /// Lays a colour over a pixel; one outside is left out.
  void blend(int x, int y, Colour colour, float opacity);

  /// Edges between pixels are covered in part. Nothing where a corner is not below and right of the other.
  void rectangle(double left, double top, double right, double bottom, Colour colour, float opacity = 1);
  /// With round ends.
  void line(double x0, double y0, double x1, double y1, double thickness, Colour colour, float opacity = 1);

  /// Three bytes a pixel, row by row.
  std::vector<std::uint8_t> rgb() const;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_, height_;
  double scale_;
  std::vector<Colour> pixels_;
};

/// Distance of (x, y) from the segment.
double distance_to_segment(double x, double y, double x0, double y0, double x1, double y1);

}  // namespace hfr::view

#endif
