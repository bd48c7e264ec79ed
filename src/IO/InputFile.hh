// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_INPUT_FILE_HH
#define HFR_IO_INPUT_FILE_HH

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace hfr::io {

/// A whole file, mapped read-only into memory; the standard input is read to its end instead.
class InputFile {
 public:
  /// Throws IoError, "PATH: cannot be opened: REASON", when the file is missing, unreadable or no regular
  /// file: a folder, a device, or a pipe, for whose other end it does not wait.
  /// `extension` is that of the path where it is empty.
  explicit InputFile(const std::filesystem::path& path, std::string extension = {});
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::string_view bytes() const { return bytes_; }
  const std::filesystem::path& path() const { return path_; }
  /// With the dot; what the file's format goes by where its content does not tell.
  const std::string& extension() const { return extension_; }

 private:
  std::filesystem::path path_;
  std::string extension_;
  std::string read_;  ///< what came by the standard input
  std::string_view bytes_;
};

}  // namespace hfr::io

#endif
