// SPDX-License-Identifier: BSD-3-Clause
#include "Canvas.hh"

#include <algorithm>
#include <cmath>

namespace hfr::view {

Colour mix(Colour a, Colour b, float share_of_b) {
  const auto part = [&](float from, float to) { return from + share_of_b * (to - from); };
  return {part(a.r, b.r), part(a.g, b.g), part(a.b, b.b)};
}

double distance_to_segment(double x, double y, double x0, double y0, double x1, double y1) {
  const double dx = x1 - x0, dy = y1 - y0;
  const double length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(x - x0 - t * dx, y - y0 - t * dy);
}

Canvas::Canvas(double width, double height, Colour background, double scale)
    : width_(static_cast<int>(std::lround(scale * width))),
      height_(static_cast<int>(std::lround(scale * height))),
      scale_(scale),
      pixels_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), background) {}

void Canvas::blend(int x, int y, Colour colour, float opacity) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_ || opacity <= 0) return;
  Colour& pixel = pixels_[index(x, y)];
  pixel = mix(pixel, colour, std::min(opacity, 1.0F));
}

void Canvas::rectangle(double left, double top, double right, double bottom, Colour colour, float opacity) {
  for (double* edge : {&left, &top, &right, &bottom}) *edge *= scale_;
  const auto covered = [](double low, double high, int pixel) {
    return std::max(0.0, std::min(high, pixel + 1.0) - std::max(low, static_cast<double>(pixel)));
  };
  const int x_end = std::min(width_, static_cast<int>(std::ceil(right)));
  const int y_end = std::min(height_, static_cast<int>(std::ceil(bottom)));
  for (int y = std::max(0, static_cast<int>(std::floor(top))); y < y_end; ++y)
    for (int x = std::max(0, static_cast<int>(std::floor(left))); x < x_end; ++x)
      blend(x, y, colour, opacity * static_cast<float>(covered(left, right, x) * covered(top, bottom, y)));
}

void Canvas::line(double x0, double y0, double x1, double y1, double thickness, Colour colour,
                  float opacity) {
  for (double* place : {&x0, &y0, &x1, &y1, &thickness}) *place *= scale_;
  const double reach = 0.5 * thickness + 1;
  const int x_end = static_cast<int>(std::ceil(std::max(x0, x1) + reach));
  const int y_end = static_cast<int>(std::ceil(std::max(y0, y1) + reach));
  for (int y = static_cast<int>(std::floor(std::min(y0, y1) - reach)); y < y_end; ++y)
    for (int x = static_cast<int>(std::floor(std::min(x0, x1) - reach)); x < x_end; ++x) {
      const double inside = 0.5 * thickness + 0.5 - distance_to_segment(x + 0.5, y + 0.5, x0, y0, x1, y1);
      blend(x, y, colour, opacity * static_cast<float>(std::clamp(inside, 0.0, std::min(1.0, thickness))));
    }
}

std::vector<std::uint8_t> Canvas::rgb() const {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * pixels_.size());
  for (const Colour& pixel : pixels_)
    for (const float part : {pixel.r, pixel.g, pixel.b})
      bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(part, 0.0F, 1.0F))));
  return bytes;
}

}  // namespace hfr::view
