// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_UNITTESTS_IO_WRITABLE_FORMATS_HH
#define HFR_UNITTESTS_IO_WRITABLE_FORMATS_HH

#include <algorithm>
#include <array>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "hfremesh/IO/MeshFile.hh"

namespace hfr::io::samples {

/// One way to write a mesh: an extension and the options for it.
struct FormatVariant {
  std::string extension;
  WriteOptions options;

  std::string name() const {
    std::string text = extension.substr(1) + options.variant + (options.binary ? "binary" : "");
    std::erase(text, '.');
    return text;
  }
  friend void PrintTo(const FormatVariant& format, std::ostream* out) { *out << format.name(); }
};

/// Every variant of every writable format that holds cells.
inline std::vector<FormatVariant> cell_formats() {
  constexpr std::array<std::string_view, 4> kSurfaceFormats = {".stl", ".obj", ".off", ".ply"};
  std::vector<FormatVariant> formats;
  for (const std::string& extension : writable_extensions()) {
    if (std::find(kSurfaceFormats.begin(), kSurfaceFormats.end(), extension) != kSurfaceFormats.end())
      continue;
    formats.push_back({extension, {}});
    const auto add = [&](std::initializer_list<std::string> variants, std::initializer_list<bool> binaries) {
      for (const std::string& variant : variants) {
        for (const bool binary : binaries) formats.push_back({extension, {binary, variant}});
      }
    };
    if (extension == ".msh") add({"2.2", "4.0", "4.1"}, {false, true});
    if (extension == ".vtk") add({"4.2", "5.1"}, {false, true});
    if (extension == ".vtu") add({"ascii", "base64", "appended", "zlib"}, {false});
  }
  return formats;
}

}  // namespace hfr::io::samples

#endif
