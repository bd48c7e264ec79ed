// SPDX-License-Identifier: BSD-3-Clause
#include "IO/TextChunks.hh"

#include <algorithm>
#include <cstring>
#include <limits>

#include "IO/Words.hh"

namespace hfr::io {
namespace {

constexpr std::uint64_t kLargestChunk = std::uint64_t{1} << 20, kSmallestChunk = 256;
constexpr std::uint64_t kChunksEach = 64;  // of a process, in a small file
constexpr std::uint64_t kLongestLine = std::uint64_t{1} << 16;

}  // namespace

bool TextLine::has_more() {
  const std::string_view text = in_.text();
  std::size_t at = in_.offset();
  while (at < end_ && is_space(text[at])) ++at;
  if (at < end_ && comment_ != 0 && text[at] == comment_) at = end_;
  in_.seek(at);
  return at < end_;
}

void TextLine::next() {
  if (!has_more())
    fail("the line ends too early; in ranges, files are read that have each entry on a line of its own");
}

int TextLine::label() {
  using Limits = std::numeric_limits<int>;
  return static_cast<int>(integer_in(Limits::min(), Limits::max(), "label"));
}

std::string_view TextLine::rest() {
  if (!has_more()) return {};
  std::string_view left = in_.text().substr(in_.offset(), end_ - in_.offset());
  while (!left.empty() && is_space(left.back())) left.remove_suffix(1);
  in_.seek(end_);
  return left;
}

void TextLine::finish() {
  if (has_more())
    fail("there is more on this line; in ranges, files are read that have each entry on a line of its own");
}

TextChunks::TextChunks(const std::filesystem::path& path, Format format, const Processes& processes)
    : file_(path), format_(std::move(format)) {
  if (file_.size() == 0) fail("the file is empty");
  chunk_size_ = std::clamp(file_.size() / (kChunksEach * processes.n), kSmallestChunk, kLargestChunk);
  scan(processes);
}

/// Its lines: those that begin in it.
void TextChunks::load(std::size_t chunk) {
  if (loaded_ == chunk) return;
  loaded_ = ~std::size_t{0};
  const std::uint64_t begin = chunk * chunk_size_, end = std::min(begin + chunk_size_, file_.size());
  text_begin_ = begin == 0 ? 0 : begin - 1;  // a line begins behind the end of another
  text_ = file_.bytes(text_begin_, std::min(end + kLongestLine, file_.size()) - text_begin_);
  lines_.clear();
  std::size_t at = 0;
  const auto past_line = [&](std::size_t from) {
    const void* const found = std::memchr(text_.data() + from, '\n', text_.size() - from);
    if (found) return static_cast<std::size_t>(static_cast<const char*>(found) - text_.data()) + 1;
    if (text_begin_ + text_.size() < file_.size())
      fail("at byte " + std::to_string(text_begin_ + from) + ": a line of more than " +
           std::to_string(kLongestLine) + " bytes; in ranges, text is read line by line");
    return text_.size();
  };
  if (begin > 0) at = past_line(0);
  while (at < end - text_begin_) {
    const std::size_t next = past_line(at);
    std::size_t first = at;
    while (first < next && is_space(text_[first])) ++first;
    if (first < next && (format_.comment == 0 || text_[first] != format_.comment))
      lines_.push_back({first, next});
    at = next;
  }
  loaded_ = chunk;
}

void TextChunks::scan(const Processes& processes) {
  struct Found {  // a mark of a chunk
    std::uint64_t chunk = 0, line = 0, byte = 0;
    std::array<char, 40> word{};
  };
  const std::uint64_t n_chunks = (file_.size() + chunk_size_ - 1) / chunk_size_;
  std::vector<std::uint64_t> counts;
  std::vector<Found> marks;
  for (std::uint64_t k = processes.rank * n_chunks / processes.n;
       k < (processes.rank + 1) * n_chunks / processes.n; ++k) {
    load(k);
    counts.push_back(lines_.size());
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Range& line = lines_[i];
      const std::string_view text(text_.data() + line.begin, line.end - line.begin);
      if (!format_.mark(text)) continue;
      Found found{k, i, text_begin_ + line.begin, {}};
      const auto length =
          static_cast<std::size_t>(std::find_if(text.begin(), text.end(), is_space) - text.begin());
      std::copy_n(text.begin(), std::min(length, found.word.size() - 1), found.word.begin());
      marks.push_back(found);
    }
  }
  counts = processes.gather(std::span<const std::uint64_t>(counts));
  first_line_.assign(1, 0);
  for (const std::uint64_t n : counts) first_line_.push_back(first_line_.back() + n);
  for (const Found& found : processes.gather(std::span<const Found>(marks)))
    marks_.push_back({first_line_[found.chunk] + found.line, found.byte, found.word.data()});
}

std::size_t TextChunks::chunk_of(std::uint64_t line) const {
  const auto above = std::upper_bound(first_line_.begin(), first_line_.end(), line);
  return static_cast<std::size_t>(above - first_line_.begin()) - 1;
}

std::string TextChunks::between(const Mark& first, const Mark& last) {
  const std::uint64_t n = last.byte - first.byte;
  file_.require_short(first.word, n);
  const std::string text = file_.bytes(first.byte, n);
  return text.substr(std::min(text.find('\n'), text.size() - 1) + 1);
}

}  // namespace hfr::io
