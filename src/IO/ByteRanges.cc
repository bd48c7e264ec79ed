// SPDX-License-Identifier: BSD-3-Clause
#include "IO/ByteRanges.hh"

#include <system_error>

#include "HalfFace/Errors.hh"

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

void ByteRanges::fail(const std::string& message) const { throw InvalidInput(name_ + ": " + message); }

}  // namespace hfr::io
