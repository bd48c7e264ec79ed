// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_SHARED_FILE_HH
#define HFR_DISTRIBUTED_SHARED_FILE_HH

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Distributed/Comm.hh"
#include "IO/ByteSink.hh"
#include "IO/OutputFile.hh"

namespace hfr::mpi {

/// A file that all ranks write to: a temporary one of rank 0, renamed in commit(). Where a rank has failed
/// before, it goes with the object. All ranks see one file system. All take part in all of it.
class SharedFile {
 public:
  SharedFile(Comm& comm, const std::filesystem::path& path);
  /// What each rank writes to at offsets.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// All have written, or a rank has failed.
  void commit();

 private:
  Comm& comm_;
  std::optional<io::OutputFile> file_;  // of rank 0
  std::filesystem::path temporary_;
};

/// Writes at offsets of a file that others write to, too; what follows on what was put last goes out with it.
class OffsetFile {
 public:
  explicit OffsetFile(std::filesystem::path path);
  ~OffsetFile();
  OffsetFile(const OffsetFile&) = delete;
  OffsetFile& operator=(const OffsetFile&) = delete;

  void put_text(std::uint64_t offset, std::string_view text) {
    if (offset != begin_ + buffer_.size() || buffer_.size() >= kBuffer) {
      flush();
      begin_ = offset;
    }
    buffer_.append(text);
  }
  void finish();  ///< flush, fsync, close

 private:
  static constexpr std::size_t kBuffer = std::size_t{1} << 20;

  void flush();
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t begin_ = 0;
  std::string buffer_;
};

/// Stretches of a file, each at its place behind those of the ranks before.
class StretchSink : public io::ByteSink {
 public:
  /// `begins`: of the stretches of this rank.
  StretchSink(OffsetFile& file, std::vector<std::uint64_t> begins)
      : file_(file), begins_(std::move(begins)), at_(begins_.front()) {}
  void next_stretch() override;
  void finish();

 private:
  void put(std::string_view bytes) override;

  OffsetFile& file_;
  std::vector<std::uint64_t> begins_;
  std::size_t stretch_ = 0;
  std::uint64_t at_;
};

/// Where the stretches of this rank begin, by how long those of all ranks are: `lengths` of this one, as many
/// on all. All take part.
std::vector<std::uint64_t> begins_of_stretches(Comm& comm, const std::vector<std::uint64_t>& lengths);

}  // namespace hfr::mpi

#endif
