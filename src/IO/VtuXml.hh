// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_VTU_XML_HH
#define HFR_IO_VTU_XML_HH

#include <tinyxml2.h>

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

/// Words of VTK's XML files.
namespace hfr::io {

inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n\v\f";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Without space around it; empty where there is none.
inline std::string_view attribute(const tinyxml2::XMLElement& element, const char* name) {
  const char* const value = element.Attribute(name);
  return value ? trimmed(value) : std::string_view();
}

/// Nothing where it is no whole number.
inline std::optional<std::uint64_t> number_attribute(const tinyxml2::XMLElement& element, const char* name) {
  const std::string_view text = attribute(element, name);
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || stop != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace hfr::io

#endif
