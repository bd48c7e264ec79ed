// SPDX-License-Identifier: BSD-3-Clause
#include "PageFiles.hh"

#include <string>

#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::view {

std::string_view page_file(std::string_view name) {
  for (const PageFile& file : page_files())
    if (name == file.name) return {file.text, file.size};
  throw InternalError("no page file " + std::string(name));
}

}  // namespace hfr::view
