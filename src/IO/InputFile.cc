// SPDX-License-Identifier: BSD-3-Clause
#include "IO/InputFile.hh"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "HalfFace/Errors.hh"

namespace hfr::io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& reason) {
  throw IoError(path.string() + ": cannot be opened: " + reason);
}

std::string reason_of(int error) { return std::generic_category().message(error); }

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(path, reason_of(errno));
  struct stat info {};
  int error = ::fstat(descriptor, &info) == 0 ? 0 : errno;
  if (error == 0 && S_ISDIR(info.st_mode)) error = EISDIR;
  // A pipe has no length and cannot be mapped; readers need the whole file at once.
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
  if (error != 0) fail(path, reason_of(error));
  if (!regular) fail(path, "Not a regular file");
}

InputFile::~InputFile() {
  if (!bytes_.empty()) ::munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

}  // namespace hfr::io
