// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_NUMBERS_HH
#define HFR_APPS_NUMBERS_HH

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "Parser.hh"

/// Checks of numbers on the command line. CLI11's own let NaN pass every range, take -1 for an unsigned
/// number, and write out the largest double with all its 309 digits.
namespace hfr::app {

/// The argument as messages quote it: cut where it is long.
std::string in_quotes(const std::string& text);

/// The whole text as a finite number; nothing when it is anything else, or too large for a double.
std::optional<double> real_of(const std::string& text);
/// The whole text as decimal digits, with a sign where Integer has one; nothing when it is anything else, or
/// does not fit.
template <class Integer>
std::optional<Integer> integer_of(std::string_view text);

/// Finite numbers from `low` to `high`; `low` itself only where `with_low`.
ValueCheck real_number(double low = -std::numeric_limits<double>::infinity(),
                       double high = std::numeric_limits<double>::infinity(), bool with_low = true);
/// Finite numbers above 0.
ValueCheck positive_number();
/// Integers from `low` to `high`.
ValueCheck whole_number(std::uint64_t low = 0,
                        std::uint64_t high = std::numeric_limits<std::uint64_t>::max());

}  // namespace hfr::app

#endif
