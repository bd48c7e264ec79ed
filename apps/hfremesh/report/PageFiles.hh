// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_REPORT_PAGE_FILES_HH
#define HFR_APPS_REPORT_PAGE_FILES_HH

#include <string_view>

namespace hfr::view {

/// The text of a file of this folder that pages are made of, embedded by the build (cmake/EmbedPage.cmake).
/// Throws InternalError for a name that there is not.
std::string_view page_file(std::string_view name);

}  // namespace hfr::view

#endif
