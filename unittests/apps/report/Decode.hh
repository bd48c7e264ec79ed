// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_APPS_REPORT_DECODE_HH
#define HFR_UNITTESTS_APPS_REPORT_DECODE_HH

#include <gtest/gtest.h>
#include <zlib.h>
#ifdef HFR_HAS_PNG
#include <png.h>
#endif

#include <array>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <vector>

/// Ways back from what pictures and pages are written in.
namespace hfr::app::test {

inline std::string unbase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int n = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    n += 6;
    if (n < 8) continue;
    n -= 8;
    bytes.push_back(static_cast<char>(bits >> n & 255));
  }
  return bytes;
}

inline std::string inflated(const std::string& bytes, std::size_t size) {
  std::string out(size, '\0');
  uLongf n = size;
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(out.data()), &n, reinterpret_cast<const Bytef*>(bytes.data()),
                       bytes.size()),
            Z_OK);
  EXPECT_EQ(n, size);
  return out;
}

#ifdef HFR_HAS_PNG
struct Decoded {
  unsigned width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  std::size_t n_colours(unsigned left, unsigned right) const {
    std::set<std::array<std::uint8_t, 3>> colours;
    for (unsigned y = 0; y < height; ++y)
      for (unsigned x = left; x < right; ++x) {
        const std::size_t at = 3 * (std::size_t{y} * width + x);
        colours.insert({rgb[at], rgb[at + 1], rgb[at + 2]});
      }
    return colours.size();
  }
};

inline Decoded decoded(const std::string& bytes) {
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  Decoded out;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) return out;
  image.format = PNG_FORMAT_RGB;
  out.rgb.resize(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, out.rgb.data(), 0, nullptr)) return {};
  out.width = image.width;
  out.height = image.height;
  return out;
}

#endif

}  // namespace hfr::app::test

#endif
