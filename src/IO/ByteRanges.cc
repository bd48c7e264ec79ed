// SPDX-License-Identifier: BSD-3-Clause
#include "IO/ByteRanges.hh"

#include <system_error>

#include "HalfFace/Errors.hh"
#include "IO/Words.hh"

namespace hfr::io {

ByteRanges::ByteRanges(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code error;
  size_ = std::filesystem::file_size(path, error);
  if (!error) in_.open(path, std::ios::binary);
  if (error || !in_) throw IoError(name_ + ": cannot be opened" + (error ? ": " + error.message() : ""));
}

std::string ByteRanges::bytes(std::uint64_t begin, std::uint64_t n) {
  std::string bytes(n, '\0');
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(begin));
  if (!in_.read(bytes.data(), static_cast<std::streamsize>(n)))
    throw IoError(name_ + ": at byte " + std::to_string(begin) + ": cannot be read");
  return bytes;
}

void ByteRanges::require_short(const std::string& section, std::uint64_t n) const {
  constexpr std::uint64_t kLongest = std::uint64_t{1} << 28;
  if (n > kLongest)
    fail("section " + shown(section) + " has " + std::to_string(n) +
         " bytes, which is more than each of several processes is made to read");
}

void ByteRanges::fail(const std::string& message) const { throw InvalidInput(name_ + ": " + message); }

}  // namespace hfr::io
