// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_WORDS_HH
#define HFR_IO_WORDS_HH

#include <string>
#include <string_view>

namespace hfr::io {

/// A to Z as a to z, and every other byte as it is, in any locale.
std::string lower(std::string_view text);

/// What a message shows of a file's text: short, and on one line whatever the bytes are.
std::string shown(std::string_view text);

}  // namespace hfr::io

#endif
