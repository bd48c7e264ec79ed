// SPDX-License-Identifier: BSD-3-Clause
#include "IO/OutputFile.hh"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>

#include "HalfFace/Errors.hh"

namespace hfr::io {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 20;
constexpr std::size_t kLongestNumber = 32;  // shortest doubles need 24 characters, 64-bit integers 20

/// Opens a new file beside `target` under a name that nothing else has. The mode is the usual one of new
/// files, 0666 less the umask, which mkstemp would not give.
std::pair<int, std::filesystem::path> open_beside(const std::filesystem::path& target) {
  constexpr int kAttempts = 1000;
  const std::string stem = "." + target.filename().string() + "." + std::to_string(::getpid()) + "-";
  for (int attempt = 0;; ++attempt) {
    std::filesystem::path candidate = target.parent_path() / (stem + std::to_string(attempt) + ".tmp");
    const int descriptor = ::open(candidate.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST || attempt == kAttempts) return {descriptor, std::move(candidate)};
  }
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& target) : target_(target), replaced_(target) {
  std::error_code ignored;
  if (const auto resolved = std::filesystem::canonical(target, ignored); !ignored) replaced_ = resolved;
  struct stat info {};
  const bool exists = ::stat(replaced_.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) fail(EISDIR);
  if (exists && ::access(replaced_.c_str(), W_OK) != 0) fail(errno);
  int descriptor = -1;
  if (exists && !S_ISREG(info.st_mode)) {
    descriptor = ::open(replaced_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    std::tie(descriptor, temporary_) = open_beside(replaced_);
  }
  if (descriptor < 0) {
    temporary_.clear();
    fail(errno);
  }
  // Permissions that cannot be taken over (a file of another owner) are no reason to lose the mesh.
  if (exists && !temporary_.empty()) static_cast<void>(::fchmod(descriptor, info.st_mode & 07777));
  file_ = ::fdopen(descriptor, "wb");
  if (!file_) {
    const int error = errno;
    ::close(descriptor);
    ::unlink(temporary_.c_str());
    fail(error);
  }
  std::setvbuf(file_, nullptr, _IONBF, 0);  // buffer_ is the buffer
  buffer_.reserve(kBufferSize + kLongestNumber);
}

OutputFile::~OutputFile() {
  if (file_) std::fclose(file_);
  if (!committed_ && !temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::fail(int error) {
  throw IoError(target_.string() + ": cannot be written: " + std::generic_category().message(error));
}

void OutputFile::flush() {
  errno = 0;
  if (std::fwrite(buffer_.data(), 1, buffer_.size(), file_) != buffer_.size()) fail(errno ? errno : EIO);
  buffer_.clear();
}

OutputFile& OutputFile::text(std::string_view text) {
  if (buffer_.size() + text.size() > kBufferSize) {
    flush();
    if (text.size() > kBufferSize) {
      errno = 0;
      if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail(errno ? errno : EIO);
      return *this;
    }
  }
  buffer_.append(text);
  return *this;
}

OutputFile& OutputFile::number(double value) {
  std::array<char, kLongestNumber> digits;
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return text({digits.data(), static_cast<std::size_t>(result.ptr - digits.data())});
}

OutputFile& OutputFile::number(std::int64_t value) {
  std::array<char, kLongestNumber> digits;
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return text({digits.data(), static_cast<std::size_t>(result.ptr - digits.data())});
}

void OutputFile::commit() {
  flush();
  errno = 0;
  // A device or pipe cannot be synced, and need not be.
  if (!temporary_.empty() && ::fsync(::fileno(file_)) != 0) fail(errno);
  std::FILE* const file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) fail(errno);
  if (!temporary_.empty() && std::rename(temporary_.c_str(), replaced_.c_str()) != 0) fail(errno);
  committed_ = true;
}

}  // namespace hfr::io
