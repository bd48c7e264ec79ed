// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_INPUT_FILE_HH
#define HFR_IO_INPUT_FILE_HH

#include <filesystem>
#include <memory>
#include <string_view>

namespace hfr::io {

/// A whole file, mapped read-only into memory.
class InputFile {
 public:
  /// Throws IoError, "PATH: cannot be opened: REASON", when the file is missing, unreadable or a folder.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::string_view bytes() const { return bytes_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::string_view bytes_;
};

}  // namespace hfr::io

#endif
