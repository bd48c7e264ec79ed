// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_GMSH_SOURCE_HH
#define HFR_IO_GMSH_SOURCE_HH

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "IO/TextScanner.hh"

namespace hfr::io::gmsh {

/// TextSource and BinarySource answer the same questions, so that each section of the format is parsed by one
/// function template. Words, lines and `ascii_` numbers are text in both kinds of file; int32(), wide(),
/// real() and any_real() are the numbers that a binary file holds as bytes.
class TextSource {
 public:
  TextSource(std::string_view text, std::string name) : scanner_(text, std::move(name)) {}

  /// Bytes that so many values take at least; what counts in the file are bounded by.
  static constexpr std::size_t least(std::size_t int32s, std::size_t wides, std::size_t reals) {
    return 2 * (int32s + wides + reals);
  }

  int int32(std::string_view what) { return ascii_integer(what); }
  std::int64_t wide() { return scanner_.integer(); }
  std::uint64_t count();  ///< refuses negative numbers
  double real() { return scanner_.real(); }
  double any_real() { return scanner_.field_value(); }  ///< also nan and inf

  bool at_end() { return scanner_.at_end(); }
  std::string_view word() { return scanner_.word(); }
  std::string_view line() { return scanner_.rest_of_line(); }
  int ascii_integer(std::string_view what) {
    return static_cast<int>(
        scanner_.integer_in(std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), what));
  }
  std::uint64_t ascii_count() { return count(); }
  double ascii_real() { return any_real(); }
  void begin_data() {}

  std::string_view text() const { return scanner_.text(); }
  std::size_t offset() const { return scanner_.offset(); }
  /// Bytes of the file from here on.
  std::uint64_t left() const { return text().size() - offset(); }
  void seek(std::size_t offset) { scanner_.seek(offset); }
  [[noreturn]] void fail(std::string_view message) const { scanner_.fail(message); }

 private:
  TextScanner scanner_;
};

/// `swap`: the numbers of the file have the other byte order than this machine. The text may be a stretch of
/// the file, with so many bytes before it and behind it.
class BinarySource {
 public:
  struct Outside {
    std::uint64_t before, behind;
  };

  BinarySource(std::string_view text, std::string name, std::size_t offset, bool swap,
               Outside outside = {0, 0})
      : text_(text), name_(std::move(name)), at_(offset), value_at_(offset), swap_(swap), outside_(outside) {}

  static constexpr std::size_t least(std::size_t int32s, std::size_t wides, std::size_t reals) {
    return 4 * int32s + 8 * (wides + reals);
  }

  int int32(std::string_view) { return get<std::int32_t>(); }
  std::int64_t wide() { return get<std::int64_t>(); }
  std::uint64_t count() { return get<std::uint64_t>(); }
  double real() {
    const double value = get<double>();
    if (!std::isfinite(value)) fail("a coordinate is not a finite number");
    return value;
  }
  double any_real() { return get<double>(); }

  bool at_end();
  std::string_view word();
  std::string_view line();
  int ascii_integer(std::string_view what);
  std::uint64_t ascii_count();
  double ascii_real();
  /// Takes the rest of the line, which is all that stands between text and bytes.
  void begin_data();

  std::string_view text() const { return text_; }
  std::size_t offset() const { return at_; }
  std::uint64_t left() const { return text_.size() - at_ + outside_.behind; }
  void seek(std::size_t offset) { at_ = value_at_ = offset; }
  [[noreturn]] void fail(std::string_view message) const;

 private:
  template <class T>
  T get() {
    value_at_ = at_;
    if (text_.size() - at_ < sizeof(T)) fail("the file ends in the middle of its data");
    char bytes[sizeof(T)];
    std::memcpy(bytes, text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if (swap_) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  std::string_view text_;
  std::string name_;
  std::size_t at_;
  std::size_t value_at_;  ///< where the last value or word began: what messages name
  bool swap_;
  Outside outside_;
};

/// `count` as a size, once it is known that so many items of at least `bytes_each` fit into the rest of the
/// file.
template <class Source>
std::size_t bounded(const Source& in, std::uint64_t count, std::size_t bytes_each, std::string_view what) {
  const std::uint64_t left = in.left();
  // The last number of a text may end with the file, without a separator: one byte of grace.
  if (count > (left + 1) / bytes_each) {
    in.fail(std::to_string(count) + " " + std::string(what) + " are announced, but only " +
            std::to_string(left) + " bytes are left");
  }
  return static_cast<std::size_t>(count);
}

}  // namespace hfr::io::gmsh

#endif
