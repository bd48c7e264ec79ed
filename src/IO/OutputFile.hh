// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_OUTPUT_FILE_HH
#define HFR_IO_OUTPUT_FILE_HH

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

#include "hfremesh/IO/ByteSink.hh"

namespace hfr::io {

/// `path` with its symbolic links followed, to a file that need not be there yet. Throws IoError where links
/// lead round in a circle.
std::filesystem::path link_target(const std::filesystem::path& path);

/// The text as the value of an attribute of XML. Control characters, which that has not, become blanks.
std::string xml_escaped(std::string_view text);

/// Removes the temporary files of all OutputFiles that are open. For a signal handler that ends the process:
/// async-signal-safe, and to be called in the thread that writes, so that no file is about to be made.
void remove_temporary_files() noexcept;

/// Buffered output to a temporary file beside the target, which replaces the target on commit() and takes
/// over its permissions. Destroyed without commit(), it leaves nothing behind. A symbolic link stays one: the
/// file it points at is replaced, or made where it is missing. Other hard links to the target keep the old
/// file. What is no regular file (kStandardOutput, a pipe, a device) is written to directly. Every failure
/// throws IoError, "PATH: cannot be written: REASON".
class OutputFile : public ByteSink {
 public:
  explicit OutputFile(const std::filesystem::path& target);
  ~OutputFile() override;

  // Those of ByteSink, with the type that commit() can follow on.
  OutputFile& text(std::string_view text) { return ByteSink::text(text), *this; }
  OutputFile& number(double value) { return ByteSink::number(value), *this; }
  OutputFile& number(std::int64_t value) { return ByteSink::number(value), *this; }
  template <class T>
  OutputFile& raw(const T& value) {
    return ByteSink::raw(value), *this;
  }
  void commit();  ///< finish(), if that has not been done, and rename
  /// Flush, fsync and close: all that may fail for want of room. Nothing can be written after it.
  void finish();
  /// The file that is to become the target, for other processes that write to it behind what this one does.
  /// Empty where the target is written to directly.
  const std::filesystem::path& temporary() const { return temporary_; }

 private:
  int open_beside();
  void remove_temporary();
  void put(std::string_view bytes) override;
  [[noreturn]] void fail(int error);

  std::filesystem::path target_;     ///< as the caller named it
  std::filesystem::path replaced_;   ///< the same with symbolic links followed
  std::filesystem::path temporary_;  ///< empty when the target is written to directly
  std::size_t slot_;                 ///< of temporary_ among those that remove_temporary_files() removes
  std::FILE* file_ = nullptr;
  bool committed_ = false;
};

/// Files of one mesh: renames them when all are whole, one after the other. Null ones are left out.
void commit_together(std::initializer_list<OutputFile*> files);

}  // namespace hfr::io

#endif
