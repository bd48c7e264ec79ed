// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_PAGE_FILES_HH
#define HFR_APPS_REPORT_PAGE_FILES_HH

#include <cstddef>
#include <span>
#include <string_view>

namespace hfr::view {

/// A file of this folder that pages are made of, embedded by the build (cmake/EmbedFiles.cmake).
struct PageFile {
  const char* name;
  const char* text;
  std::size_t size;
};

std::span<const PageFile> page_files();

/// The text of one of them. Throws InternalError for a name that there is not.
std::string_view page_file(std::string_view name);

}  // namespace hfr::view

#endif
