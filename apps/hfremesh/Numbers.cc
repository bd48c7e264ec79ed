// SPDX-License-Identifier: BSD-3-Clause
#include "Numbers.hh"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace hfr::app {
namespace {

/// "a number from 0 to 180", "a number above 0".
std::string wanted(const char* kind, const std::string& low, const std::string& high, bool with_low) {
  std::string text = kind;
  if (!low.empty()) text += (with_low ? " from " : " above ") + low + (with_low && high.empty() ? " on" : "");
  if (!high.empty()) text += " to " + high;
  return text;
}

}  // namespace

std::string in_quotes(const std::string& text) {
  constexpr std::size_t kLongest = 40;
  return "'" + (text.size() > kLongest ? text.substr(0, kLongest) + "..." : text) + "'";
}

std::optional<double> real_of(const std::string& text) {
  char* end = nullptr;  // by way of long double, as the parser of the command line does
  const auto value = static_cast<double>(std::strtold(text.c_str(), &end));
  if (text.empty() || end != text.c_str() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

template <class Integer>
std::optional<Integer> integer_of(std::string_view text) {
  Integer value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

template std::optional<int> integer_of(std::string_view);
template std::optional<std::uint64_t> integer_of(std::string_view);

ValueCheck real_number(double low, double high, bool with_low) {
  const auto bound = [](double x) { return std::isfinite(x) ? fmt::format("{}", x) : std::string(); };
  const std::string range = wanted("a number", bound(low), bound(high), with_low);
  const auto check = [=](const std::string& text) {
    const std::optional<double> value = real_of(text);
    if (value && (*value > low || (with_low && *value == low)) && *value <= high) return std::string();
    return fmt::format("{} is wanted, not {}", range, in_quotes(text));
  };
  return check;
}

ValueCheck positive_number() { return real_number(0, std::numeric_limits<double>::infinity(), false); }

ValueCheck whole_number(std::uint64_t low, std::uint64_t high) {
  const bool bounded = high < std::numeric_limits<std::uint64_t>::max();
  const std::string range =
      wanted("a whole number", fmt::format("{}", low), bounded ? fmt::format("{}", high) : "", true);
  const auto check = [=](const std::string& text) {
    // The parser would read one that begins with 0 by eights.
    const bool leads_with_zero = text.size() > 1 && text[0] == '0';
    const std::optional<std::uint64_t> value = integer_of<std::uint64_t>(text);
    if (value && *value >= low && *value <= high && !leads_with_zero) return std::string();
    return fmt::format("{} is wanted, not {}", range, in_quotes(text));
  };
  return check;
}

}  // namespace hfr::app
