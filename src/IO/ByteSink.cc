// SPDX-License-Identifier: BSD-3-Clause
#include "IO/ByteSink.hh"

#include <array>
#include <charconv>

namespace hfr::io {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 20;
constexpr std::size_t kLongestNumber = 32;  // shortest doubles need 24 characters, 64-bit integers 20

template <class T>
std::string_view written(std::array<char, kLongestNumber>& digits, T value) {
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), static_cast<std::size_t>(result.ptr - digits.data())};
}

}  // namespace

ByteSink::ByteSink() { buffer_.reserve(kBufferSize + kLongestNumber); }

void ByteSink::flush() {
  put(buffer_);
  buffer_.clear();
}

ByteSink& ByteSink::text(std::string_view text) {
  if (buffer_.size() + text.size() > kBufferSize) {
    flush();
    if (text.size() > kBufferSize) {
      put(text);
      return *this;
    }
  }
  buffer_.append(text);
  return *this;
}

ByteSink& ByteSink::number(double value) {
  std::array<char, kLongestNumber> digits;
  return text(written(digits, value));
}

ByteSink& ByteSink::number(std::int64_t value) {
  std::array<char, kLongestNumber> digits;
  return text(written(digits, value));
}

}  // namespace hfr::io
