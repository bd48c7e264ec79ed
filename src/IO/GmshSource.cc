// SPDX-License-Identifier: BSD-3-Clause
#include "IO/GmshSource.hh"

#include <charconv>

#include "HalfFace/Errors.hh"
#include "IO/Words.hh"

namespace hfr::io::gmsh {
namespace {

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
  while (!line.empty() && is_space(line.back())) line.remove_suffix(1);
  return line;
}

/// The number that all of `word` spells. False when it does not.
template <class T>
bool parse(std::string_view word, T& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  return error == std::errc{} && stop == end;
}

}  // namespace

std::uint64_t TextSource::count() {
  const std::int64_t value = scanner_.integer();
  if (value < 0) fail("a count cannot be negative, but " + std::to_string(value) + " stands here");
  return static_cast<std::uint64_t>(value);
}

void BinarySource::fail(std::string_view message) const {
  throw InvalidInput(name_ + ": at byte " + std::to_string(outside_.before + value_at_) + ": " +
                     std::string(message));
}

bool BinarySource::at_end() {
  while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  value_at_ = at_;
  return at_ == text_.size();
}

std::string_view BinarySource::word() {
  if (at_end()) fail("the file ends where more was expected");
  while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
  return text_.substr(value_at_, at_ - value_at_);
}

std::string_view BinarySource::line() {
  value_at_ = at_;
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  at_ = std::min(end + 1, text_.size());
  return trimmed(text_.substr(value_at_, end - value_at_));
}

int BinarySource::ascii_integer(std::string_view what) {
  const std::string_view digits = word();
  int value = 0;
  if (!parse(digits, value)) fail("expected " + std::string(what) + " and found '" + shown(digits) + "'");
  return value;
}

std::uint64_t BinarySource::ascii_count() {
  const std::string_view digits = word();
  std::uint64_t value = 0;
  if (!parse(digits, value)) fail("expected a count and found '" + shown(digits) + "'");
  return value;
}

double BinarySource::ascii_real() {
  const std::string_view digits = word();
  double value = 0;
  if (!parse(digits, value)) fail("expected a number and found '" + shown(digits) + "'");
  return value;
}

void BinarySource::begin_data() {
  if (!line().empty()) fail("expected the end of the line before binary data");
}

}  // namespace hfr::io::gmsh
