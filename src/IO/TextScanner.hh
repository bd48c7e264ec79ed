// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_TEXT_SCANNER_HH
#define HFR_IO_TEXT_SCANNER_HH

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace hfr::io {

/// Reads white-space separated words and numbers from a text in memory, at the speed of std::from_chars.
/// Every failure throws InvalidInput as "NAME:LINE: what was expected, and what stood there".
class TextScanner {
 public:
  /// `name` is what messages begin with (the path). From `comment` to the end of a line is skipped (0: none).
  TextScanner(std::string_view text, std::string name, char comment = 0);

  bool at_end();                    ///< nothing but white space and comments is left
  std::string_view word();          ///< next word; throws at the end
  std::string_view peek_word();     ///< next word without taking it; empty at the end
  std::string_view rest_of_line();  ///< up to the line's end, trimmed; takes the line break
  double real();                    ///< finite double ("nan" and "inf" throw); Fortran's 1.0D+3 is read too
  double field_value();             ///< as real(), but "nan" and "inf" pass: a field may hold them
  std::int64_t integer();           ///< decimal integer
  std::int64_t integer_in(std::int64_t low, std::int64_t high, std::string_view what);
  /// A number of items that follow, each of `words_per_item` words: fails when the rest of the text is too
  /// short to hold them, so that a broken count never makes a reader allocate more than the file's own size.
  std::size_t count(std::size_t words_per_item, std::string_view what);
  bool skip_to_line_starting(std::string_view prefix);  ///< false when there is none

  std::size_t offset() const { return static_cast<std::size_t>(at_ - begin_); }
  void seek(std::size_t offset) { at_ = begin_ + offset; }
  std::string_view text() const { return {begin_, static_cast<std::size_t>(end_ - begin_)}; }
  const std::string& name() const { return name_; }
  /// False: the file may have been cut in the middle of its last number.
  bool ends_with_line_break() const { return begin_ == end_ || end_[-1] == '\n' || end_[-1] == '\r'; }
  std::size_t line() const;  ///< 1-based, of the current position; O(bytes before it)
  [[noreturn]] void fail(std::string_view message) const;

 private:
  void skip_space();
  double parse_real(bool finite);
  double parse_real_slowly(bool finite);
  [[noreturn]] void fail_expecting(std::string_view what);

  const char* begin_;
  const char* at_;
  const char* end_;
  std::string name_;
  char comment_;
};

}  // namespace hfr::io

#endif
