// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_OUTPUT_FILE_HH
#define HFR_IO_OUTPUT_FILE_HH

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace hfr::io {

/// `path` with its symbolic links followed, to a file that need not be there yet. Throws IoError where links
/// lead round in a circle.
std::filesystem::path link_target(const std::filesystem::path& path);

/// Removes the temporary files of all OutputFiles that are open. For a signal handler that ends the process:
/// async-signal-safe, and to be called in the thread that writes, so that no file is about to be made.
void remove_temporary_files() noexcept;

/// Buffered output to a temporary file beside the target, which replaces the target on commit() and takes
/// over its permissions. Destroyed without commit(), it leaves nothing behind. A symbolic link stays one: the
/// file it points at is replaced, or made where it is missing. Other hard links to the target keep the old
/// file. What is no regular file (kStandardOutput, a pipe, a device) is written to directly. Every failure
/// throws IoError, "PATH: cannot be written: REASON".
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  OutputFile& text(std::string_view text);  ///< as it is; also for raw bytes
  OutputFile& number(double value);         ///< shortest text that reads back to the same bits
  OutputFile& number(std::int64_t value);
  template <class T>
  OutputFile& raw(const T& value) {
    return text({reinterpret_cast<const char*>(&value), sizeof value});
  }
  void commit();  ///< flush, fsync, rename
  /// The file that is to become the target, for other processes that write to it behind what this one does.
  /// Empty where the target is written to directly.
  const std::filesystem::path& temporary() const { return temporary_; }

 private:
  int open_beside();
  void remove_temporary();
  void flush();
  [[noreturn]] void fail(int error);

  std::filesystem::path target_;     ///< as the caller named it
  std::filesystem::path replaced_;   ///< the same with symbolic links followed
  std::filesystem::path temporary_;  ///< empty when the target is written to directly
  std::size_t slot_;                 ///< of temporary_ among those that remove_temporary_files() removes
  std::FILE* file_ = nullptr;
  std::string buffer_;
  bool committed_ = false;
};

}  // namespace hfr::io

#endif
