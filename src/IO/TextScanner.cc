// SPDX-License-Identifier: BSD-3-Clause
#include "IO/TextScanner.hh"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>
#include <utility>

#include "HalfFace/Errors.hh"
#include "IO/Words.hh"

namespace hfr::io {

TextScanner::TextScanner(std::string_view text, std::string name, char comment)
    : begin_(text.data()),
      at_(text.data()),
      end_(text.data() + text.size()),
      name_(std::move(name)),
      comment_(comment) {}

void TextScanner::skip_space() {
  while (at_ != end_) {
    if (is_space(*at_)) {
      ++at_;
    } else if (comment_ != 0 && *at_ == comment_) {
      const void* const line_end = std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_));
      at_ = line_end ? static_cast<const char*>(line_end) : end_;
    } else {
      return;
    }
  }
}

bool TextScanner::at_end() {
  skip_space();
  return at_ == end_;
}

std::string_view TextScanner::peek_word() {
  skip_space();
  const char* stop = at_;
  while (stop != end_ && !is_space(*stop) && (comment_ == 0 || *stop != comment_)) ++stop;
  return {at_, static_cast<std::size_t>(stop - at_)};
}

std::string_view TextScanner::word() {
  const std::string_view found = peek_word();
  if (found.empty()) fail("the file ends too early: expected a word");
  at_ += found.size();
  return found;
}

std::string_view TextScanner::rest_of_line() {
  const void* const found =
      at_ == end_ ? nullptr : std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_));
  const char* const line_end = found ? static_cast<const char*>(found) : end_;
  const char* first = at_;
  const char* last = line_end;
  at_ = found ? line_end + 1 : end_;
  while (first != last && is_space(*first)) ++first;
  while (first != last && is_space(last[-1])) --last;
  return {first, static_cast<std::size_t>(last - first)};
}

void TextScanner::fail_expecting(std::string_view what) {
  const std::string_view found = peek_word();
  if (found.empty()) fail("the file ends too early: expected " + std::string(what));
  fail("expected " + std::string(what) + ", found '" + shown(found) + "'");
}

double TextScanner::parse_real(bool finite) {
  skip_space();
  double value = 0.0;
  const auto [stop, error] = std::from_chars(at_, end_, value);
  const bool whole = stop == end_ || is_space(*stop) || (comment_ != 0 && *stop == comment_);
  if (error != std::errc{} || !whole || !std::isfinite(value)) [[unlikely]] {
    return parse_real_slowly(finite);
  }
  at_ = stop;
  return value;
}

/// What from_chars does not take as it stands: a leading '+', Fortran's exponent letter D, numbers too small
/// for a normal double (which become 0), and nan and inf.
double TextScanner::parse_real_slowly(bool finite) {
  std::string text(peek_word());
  const std::size_t length = text.size();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.erase(0, 1);
  if (text.find_first_not_of("0123456789.+-dD") == std::string::npos) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
  }
  double value = 0.0;
  const char* const last = text.data() + text.size();
  auto [stop, error] = std::from_chars(text.data(), last, value);
  if (error == std::errc::result_out_of_range) {
    // The wider type tells too small from too large.
    long double wide = 0.0L;
    std::tie(stop, error) = [&] {
      const auto result = std::from_chars(text.data(), last, wide);
      return std::pair(result.ptr, result.ec);
    }();
    value = static_cast<double>(wide);
    if (!std::isfinite(value)) error = std::errc::result_out_of_range;
  }
  if (error == std::errc::result_out_of_range) fail_expecting("a number that fits a double");
  if (error != std::errc{} || stop != last) fail_expecting("a number");
  if (finite && !std::isfinite(value)) fail_expecting("a finite number");
  at_ += length;
  return value;
}

double TextScanner::real() { return parse_real(true); }

double TextScanner::field_value() { return parse_real(false); }

std::int64_t TextScanner::integer() {
  skip_space();
  const char* first = at_;
  const bool negative = first != end_ && *first == '-';
  if (negative || (first != end_ && *first == '+')) ++first;
  constexpr std::ptrdiff_t kSafeDigits = 18;  // what cannot overflow
  const char* digit = first;
  std::int64_t value = 0;
  for (; digit != end_ && digit - first < kSafeDigits; ++digit) {
    const auto next = static_cast<unsigned>(*digit - '0');
    if (next > 9) break;
    value = 10 * value + static_cast<std::int64_t>(next);
  }
  if (negative) value = -value;
  if (digit - first == kSafeDigits) [[unlikely]] {
    const auto result = std::from_chars(negative ? at_ : first, end_, value);
    if (result.ec != std::errc{}) fail_expecting("an integer of at most 64 bits");
    digit = result.ptr;
  }
  const bool whole = digit == end_ || is_space(*digit) || (comment_ != 0 && *digit == comment_);
  if (digit == first || !whole) [[unlikely]]
    fail_expecting("an integer");
  at_ = digit;
  return value;
}

std::int64_t TextScanner::integer_in(std::int64_t low, std::int64_t high, std::string_view what) {
  skip_space();
  const char* const before = at_;
  const std::int64_t value = integer();
  if (value < low || value > high) [[unlikely]] {
    at_ = before;
    if (high < low)
      fail(std::string(what) + " " + std::to_string(value) + " is out of range (there are none)");
    fail(std::string(what) + " " + std::to_string(value) + " is out of range (" + std::to_string(low) +
         " to " + std::to_string(high) + ")");
  }
  return value;
}

std::size_t TextScanner::count(std::size_t words_per_item, std::string_view what) {
  const std::int64_t items = integer_in(0, std::numeric_limits<std::int64_t>::max(), what);
  // A word takes at least one byte and the space before it.
  const auto words_left = static_cast<std::size_t>(end_ - at_) / 2;
  if (static_cast<std::size_t>(items) > words_left / std::max<std::size_t>(words_per_item, 1)) {
    fail(std::string(what) + " " + std::to_string(items) + " is more than the rest of the file can hold");
  }
  return static_cast<std::size_t>(items);
}

bool TextScanner::skip_to_line_starting(std::string_view prefix) {
  const char* line_start = at_;
  if (line_start != begin_ && line_start[-1] != '\n') {
    const void* const found = std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_));
    if (!found) return false;
    line_start = static_cast<const char*>(found) + 1;
  }
  while (line_start != end_) {
    const auto left = static_cast<std::size_t>(end_ - line_start);
    if (std::string_view(line_start, left).starts_with(prefix)) {
      at_ = line_start;
      return true;
    }
    const void* const found = std::memchr(line_start, '\n', left);
    if (!found) return false;
    line_start = static_cast<const char*>(found) + 1;
  }
  return false;
}

std::size_t TextScanner::line() const { return 1 + static_cast<std::size_t>(std::count(begin_, at_, '\n')); }

void TextScanner::fail(std::string_view message) const {
  throw InvalidInput(name_ + ":" + std::to_string(line()) + ": " + std::string(message));
}

}  // namespace hfr::io
