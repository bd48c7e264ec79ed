// SPDX-License-Identifier: BSD-3-Clause
#include "IO/InputFile.hh"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "HalfFace/Errors.hh"
#include "IO/MeshFile.hh"

namespace hfr::io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& reason) {
  throw IoError(path.string() + ": cannot be opened: " + reason);
}

std::string reason_of(int error) { return std::generic_category().message(error); }

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  if (error == ENOMEM) throw ResourceLimit(path.string() + ": not enough memory");
  fail(path, reason_of(error));
}

std::string read_to_end(int descriptor, const std::filesystem::path& path) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // bytes
  std::string bytes;
  std::size_t size = 0;
  for (;;) {
    if (bytes.size() - size < kAtOnce) bytes.resize(2 * bytes.size() + kAtOnce);
    const ssize_t n = ::read(descriptor, bytes.data() + size, bytes.size() - size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(path, errno);
    size += static_cast<std::size_t>(n);
    if (n == 0) break;
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path, std::string extension)
    : path_(path), extension_(extension.empty() ? path.extension().string() : std::move(extension)) {
  if (path == kStandardInput) {
    read_ = read_to_end(STDIN_FILENO, path);
    bytes_ = read_;
    return;
  }
  // Without O_NONBLOCK a pipe would be waited for before it can be refused.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) fail(path, errno);
  struct stat info {};
  int error = ::fstat(descriptor, &info) == 0 ? 0 : errno;
  if (error == 0 && S_ISDIR(info.st_mode)) error = EISDIR;
  // Readers need the whole file at once, and a pipe or device has no length.
  const bool regular = error != 0 || S_ISREG(info.st_mode);
  if (error == 0 && regular && info.st_size > 0) {
    const auto size = static_cast<std::size_t>(info.st_size);
    void* const start = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (start == MAP_FAILED) {
      error = errno;
    } else {
      ::madvise(start, size, MADV_SEQUENTIAL);
      bytes_ = {static_cast<const char*>(start), size};
    }
  }
  ::close(descriptor);
  if (error != 0) fail(path, error);
  if (!regular) fail(path, "Not a regular file");
}

InputFile::~InputFile() {
  if (!bytes_.empty() && read_.empty()) ::munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

}  // namespace hfr::io
