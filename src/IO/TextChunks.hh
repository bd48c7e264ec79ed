// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_TEXT_CHUNKS_HH
#define HFR_IO_TEXT_CHUNKS_HH

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "IO/ByteRanges.hh"
#include "IO/MeshShare.hh"
#include "IO/TextScanner.hh"

namespace hfr::io {

/// One line of a text while it is read.
class TextLine {
 public:
  /// `in` stands at the line's beginning, which ends at offset `end`.
  TextLine(TextScanner& in, std::size_t end, char comment) : in_(in), end_(end), comment_(comment) {}

  /// Whether a word is left.
  bool has_more();
  std::string_view word() { return next(), in_.word(); }
  double real() { return next(), in_.real(); }
  double any_real() { return next(), in_.field_value(); }
  std::int64_t integer() { return next(), in_.integer(); }
  std::int64_t integer_in(std::int64_t low, std::int64_t high, std::string_view what) {
    return next(), in_.integer_in(low, high, what);
  }
  int label();
  /// What is left of the line.
  std::string_view rest();
  /// Fails where a word is left: lines hold one entry each.
  void finish();
  [[noreturn]] void fail(std::string_view message) const { in_.fail(message); }

 private:
  void next();

  TextScanner& in_;
  std::size_t end_;
  char comment_;
};

/// A text whose lines several processes read, each some of them, and none holds all. Lines are counted
/// without those that are blank. What each process has counted in its stretch all know afterwards: 8 bytes a
/// chunk.
class TextChunks {
 public:
  struct Format {
    char comment = 0;  ///< from there to the end of a line nothing counts; 0: none
    std::function<bool(std::string_view)>
        mark;  ///< whether a line, without space before it, begins a section
  };
  /// A line that begins a section.
  struct Mark {
    std::uint64_t line = 0, byte = 0;
    std::string word;  ///< the first one of it
  };

  /// All processes make one at the same time.
  TextChunks(const std::filesystem::path& path, Format format, const Processes& processes);

  const std::string& name() const { return file_.name(); }
  std::uint64_t n_lines() const { return first_line_.back(); }
  const std::vector<Mark>& marks() const { return marks_; }
  /// body(number, TextLine&) for the lines begin … end-1. O(their chunks).
  template <class Body>
  void for_lines(std::uint64_t begin, std::uint64_t end, Body&& body) {
    for (std::uint64_t number = begin; number < end;) {
      const std::size_t chunk = chunk_of(number);
      load(chunk);
      TextScanner in(text_, name() + ": lines after byte " + std::to_string(text_begin_), format_.comment);
      for (const Range& line : lines_of(number - first_line_[chunk], end - first_line_[chunk])) {
        in.seek(line.begin);
        TextLine one(in, line.end, format_.comment);
        body(number++, one);
      }
    }
  }
  /// The same for one line, for which `body` returns something.
  template <class Body>
  auto at_line(std::uint64_t number, Body&& body) {
    decltype(body(std::declval<TextLine&>())) result{};
    if (number >= n_lines()) fail("the file ends too early");
    for_lines(number, number + 1, [&](std::uint64_t, TextLine& line) { result = body(line); });
    return result;
  }
  /// What stands between two lines, the first one left out. Throws InvalidInput where that is too long to be
  /// read by every process.
  std::string between(const Mark& first, const Mark& last);
  [[noreturn]] void fail(const std::string& message) const { file_.fail(message); }

 private:
  struct Range {
    std::size_t begin = 0, end = 0;  // in text_
  };

  std::size_t chunk_of(std::uint64_t line) const;
  void load(std::size_t chunk);
  std::span<const Range> lines_of(std::uint64_t begin, std::uint64_t end) const {
    const auto n = static_cast<std::uint64_t>(lines_.size());
    return std::span(lines_).subspan(begin, std::min(end, n) - begin);
  }
  void scan(const Processes& processes);

  ByteRanges file_;
  Format format_;
  std::uint64_t chunk_size_ = 0;
  std::vector<std::uint64_t>
      first_line_;  // of each chunk: number of the first line that begins in it; one more
  std::vector<Mark> marks_;
  // The chunk that was read last: its lines begin in it, and may end behind it.
  std::size_t loaded_ = ~std::size_t{0};
  std::uint64_t text_begin_ = 0;
  std::string text_;
  std::vector<Range> lines_;
};

}  // namespace hfr::io

#endif
