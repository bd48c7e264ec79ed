// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_OUTPUT_FILE_HH
#define HFR_IO_OUTPUT_FILE_HH

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace hfr::io {

/// Buffered output to a temporary file beside the target, which replaces the target on commit() and takes
/// over its permissions. Destroyed without commit(), it leaves nothing behind. A symbolic link stays one: the
/// file it points at is replaced. What is no regular file (/dev/stdout, a pipe) is written to directly. Every
/// failure throws IoError, "PATH: cannot be written: REASON".
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

 private:
  void flush();
  [[noreturn]] void fail(int error);

  std::filesystem::path target_;     ///< as the caller named it
  std::filesystem::path replaced_;   ///< the same with symbolic links followed
  std::filesystem::path temporary_;  ///< empty when the target is written to directly
  std::FILE* file_ = nullptr;
  std::string buffer_;
  bool committed_ = false;
};

}  // namespace hfr::io

#endif
