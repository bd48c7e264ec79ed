// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_PNG_HH
#define HFR_APPS_REPORT_PNG_HH

#include <string>
#include <vector>

#include "Canvas.hh"

namespace hfr::view {

/// False in a build without libpng.
bool has_png();
/// The bytes of a PNG file with at most 256 colours, the same for the same canvas: `kept`, at most 200, which
/// count however few pixels have them, and the most frequent ones. Throws InternalError where libpng fails or
/// is not there.
std::string png_of(const Canvas& canvas, const std::vector<Colour>& kept = {});

}  // namespace hfr::view

#endif
