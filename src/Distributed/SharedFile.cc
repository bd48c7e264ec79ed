// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/SharedFile.hh"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <span>
#include <system_error>

#include "HalfFace/Errors.hh"

namespace hfr::mpi {

SharedFile::SharedFile(Comm& comm, const std::filesystem::path& path) : comm_(comm) {
  std::string name;
  if (comm.rank() == 0) {
    file_.emplace(path);
    name = file_->temporary().string();
    if (name.empty()) throw IoError(path.string() + ": cannot be written at offsets: it is no regular file");
  }
  const std::vector<char> all = comm.all_gather(std::span<const char>(name.data(), name.size()));
  temporary_ = std::string(all.begin(), all.end());
}

void SharedFile::commit() {
  comm_.sum(0);
  if (file_) file_->commit();
  comm_.sum(0);
}

OffsetFile::OffsetFile(std::filesystem::path path) : path_(std::move(path)) {
  file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  if (file_ < 0) fail();
}

OffsetFile::~OffsetFile() {
  if (file_ >= 0) ::close(file_);
}

void OffsetFile::finish() {
  flush();
  if (::fsync(file_) != 0 && errno != EINVAL) fail();
  if (::close(std::exchange(file_, -1)) != 0) fail();
}

void OffsetFile::flush() {
  std::string_view left = buffer_;
  for (std::uint64_t at = begin_; !left.empty();) {
    const ssize_t n = ::pwrite(file_, left.data(), left.size(), static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail();
    at += static_cast<std::uint64_t>(n);
    left.remove_prefix(static_cast<std::size_t>(n));
  }
  buffer_.clear();
}

void OffsetFile::fail() const {
  throw IoError(path_.string() + ": cannot be written: " + std::generic_category().message(errno));
}

void StretchSink::next_stretch() {
  flush();
  at_ = begins_.at(++stretch_);
}

void StretchSink::finish() { flush(); }

void StretchSink::put(std::string_view bytes) {
  file_.put_text(at_, bytes);
  at_ += bytes.size();
}

std::vector<std::uint64_t> begins_of_stretches(Comm& comm, const std::vector<std::uint64_t>& lengths) {
  const auto all = comm.all_gather(std::span<const std::uint64_t>(lengths));
  const std::size_t n = lengths.size();
  if (all.size() != n * comm.n_ranks()) throw InternalError("ranks disagree about the stretches of a file");
  std::vector<std::uint64_t> begins(n);
  std::uint64_t at = 0;
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t r = 0; r < comm.n_ranks(); ++r) {
      if (r == static_cast<std::size_t>(comm.rank())) begins[k] = at;
      at += all[r * n + k];
    }
  return begins;
}

}  // namespace hfr::mpi
