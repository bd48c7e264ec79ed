// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_WORDS_HH
#define HFR_IO_WORDS_HH

#include <string>
#include <string_view>

namespace hfr::io {

/// Blank, tab, line feed, vertical tab, form feed, carriage return. Bytes are compared unsigned, so that
/// nothing beyond ASCII counts as space.
constexpr bool is_space(char c) { return c == ' ' || static_cast<unsigned char>(c - '\t') < 5; }

/// A to Z as a to z, and every other byte as it is, in any locale.
std::string lower(std::string_view text);

/// What a message shows of a file's text: short, and on one line whatever the bytes are.
std::string shown(std::string_view text);

}  // namespace hfr::io

#endif
