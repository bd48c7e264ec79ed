// SPDX-License-Identifier: BSD-3-Clause
#include "Png.hh"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::view {
namespace {

constexpr std::size_t kMostColours = 256;
constexpr int kSameColour = 6 * 6;            // square of a distance that nobody sees
constexpr std::size_t kCells = 32 * 32 * 32;  // of the colours, by the upper five bits of each part

using Bytes = std::array<std::uint8_t, 3>;

std::size_t cell_of_colour(Bytes c) {
  return static_cast<std::size_t>(c[0] >> 3) << 10 | static_cast<std::size_t>(c[1] >> 3) << 5 | c[2] >> 3;
}

std::vector<Bytes> bytes_of(const std::vector<Colour>& colours) {
  std::vector<Bytes> bytes;
  const auto byte = [](float part) { return static_cast<std::uint8_t>(std::lround(255 * part)); };
  for (const Colour& c : colours) bytes.push_back({byte(c.r), byte(c.g), byte(c.b)});
  return bytes;
}

/// A colour map, and the place in it of each cell of colours.
struct Palette {
  std::vector<Bytes> colours;
  std::vector<std::uint8_t> place = std::vector<std::uint8_t>(kCells);
};

/// The colours to keep, and the means of the cells that most pixels are in, ties to the smaller cell; the
/// others get the nearest of these.
Palette palette_of(const std::vector<Bytes>& pixels, const std::vector<Bytes>& kept) {
  std::vector<std::uint32_t> count(kCells);
  std::vector<std::array<std::uint64_t, 3>> sum(kCells);
  for (const Bytes& pixel : pixels) {
    const std::size_t cell = cell_of_colour(pixel);
    ++count[cell];
    for (std::size_t i = 0; i < 3; ++i) sum[cell][i] += pixel[i];
  }
  std::vector<std::size_t> used;
  for (std::size_t cell = 0; cell < kCells; ++cell)
    if (count[cell] > 0) used.push_back(cell);
  std::stable_sort(used.begin(), used.end(),
                   [&](std::size_t a, std::size_t b) { return count[a] > count[b]; });
  const auto mean = [&](std::size_t cell, std::size_t i) {
    return static_cast<std::uint8_t>((sum[cell][i] + count[cell] / 2) / count[cell]);
  };
  Palette palette;
  palette.colours = kept;
  for (const std::size_t cell : used) {
    const Bytes colour = {mean(cell, 0), mean(cell, 1), mean(cell, 2)};
    const auto distance = [&](const Bytes& other) {
      int d = 0;
      for (std::size_t i = 0; i < 3; ++i) d += (other[i] - colour[i]) * (other[i] - colour[i]);
      return d;
    };
    const auto is_near = [&](const Bytes& other) { return distance(other) <= kSameColour; };
    if (palette.colours.size() < kMostColours &&
        std::none_of(palette.colours.begin(), palette.colours.end(), is_near))
      palette.colours.push_back(colour);
    const auto nearest =
        std::min_element(palette.colours.begin(), palette.colours.end(),
                         [&](const Bytes& a, const Bytes& b) { return distance(a) < distance(b); });
    palette.place[cell] = static_cast<std::uint8_t>(nearest - palette.colours.begin());
  }
  return palette;
}

}  // namespace

bool has_png() { return true; }

std::string png_of(const Canvas& canvas, const std::vector<Colour>& kept) {
  const std::vector<std::uint8_t> rgb = canvas.rgb();
  std::vector<Bytes> pixels(rgb.size() / 3);
  std::memcpy(pixels.data(), rgb.data(), rgb.size());
  const Palette palette = palette_of(pixels, bytes_of(kept));
  std::vector<std::uint8_t> places(pixels.size());
  std::transform(pixels.begin(), pixels.end(), places.begin(),
                 [&](const Bytes& pixel) { return palette.place[cell_of_colour(pixel)]; });
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(canvas.width());
  image.height = static_cast<png_uint_32>(canvas.height());
  image.format = PNG_FORMAT_RGB_COLORMAP;
  image.colormap_entries = static_cast<png_uint_32>(palette.colours.size());
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, places.data(), 0, palette.colours.data()))
    throw InternalError(std::string("the picture cannot be encoded: ") + image.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace hfr::view
