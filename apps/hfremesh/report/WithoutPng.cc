// SPDX-License-Identifier: BSD-3-Clause
// Instead of Png.cc in builds without libpng.
#include "Png.hh"

#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::view {

bool has_png() { return false; }

std::string png_of(const Canvas& /*canvas*/, const std::vector<Colour>& /*kept*/) {
  throw InternalError("this build has no libpng");
}

}  // namespace hfr::view
