// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_BYTE_RANGES_HH
#define HFR_IO_BYTE_RANGES_HH

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace hfr::io {

/// A file that is never held whole: bytes are read from wherever they are asked for.
class ByteRanges {
 public:
  /// Throws IoError where it cannot be opened.
  explicit ByteRanges(const std::filesystem::path& path);

  /// The path, with which messages begin.
  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }
  /// The n bytes from `begin` on. Throws IoError where they cannot be read.
  std::string bytes(std::uint64_t begin, std::uint64_t n);
  /// Throws InvalidInput where n bytes are too many to be read by every one of several processes.
  void require_short(const std::string& section, std::uint64_t n) const;
  /// Throws InvalidInput, "PATH: MESSAGE".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string name_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
};

}  // namespace hfr::io

#endif
