// SPDX-License-Identifier: BSD-3-Clause
#include "IO/OutputFile.hh"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <random>
#include <system_error>

#include "HalfFace/Errors.hh"
#include "IO/MeshFile.hh"

namespace hfr::io {
namespace {

/// Names of the temporary files that this process has open. A signal handler can neither wait for a lock nor
/// be handed anything, so they stand here; files beyond so many are not removed by it.
constexpr std::size_t kMostListed = 64;
std::array<std::atomic<const char*>, kMostListed> temporary_names{};
static_assert(std::atomic<const char*>::is_always_lock_free);

/// The name stays where it is until the slot is cleared. Returns kMostListed when all slots are taken.
std::size_t list_temporary(const char* name) {
  for (std::size_t slot = 0; slot < kMostListed; ++slot) {
    const char* expected = nullptr;
    if (temporary_names[slot].compare_exchange_strong(expected, name)) return slot;
  }
  return kMostListed;
}

/// A name that no other file has, short whatever the target is called, and still telling whose it is.
std::string temporary_name(const std::filesystem::path& target) {
  constexpr std::size_t kMostOfName = 64;  // bytes
  std::string stem = target.filename().string();
  std::size_t length = std::min(stem.size(), kMostOfName);
  const auto inside_character = [&] { return (static_cast<unsigned char>(stem[length]) & 0xc0) == 0x80; };
  while (length > 0 && length < stem.size() && inside_character()) --length;
  stem.resize(length);
  std::random_device random;
  std::string digits;
  for (int i = 0; i < 2; ++i)
    for (std::uint32_t bits = random(), k = 0; k < 8; ++k, bits >>= 4)
      digits += "0123456789abcdef"[bits & 15];
  return "." + stem + "." + digits + ".tmp";
}

bool is_standard_output(const std::filesystem::path& target) { return target == kStandardOutput; }

}  // namespace

std::filesystem::path link_target(const std::filesystem::path& path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  std::filesystem::path now = path;
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code no_link;
    const std::filesystem::path next = std::filesystem::read_symlink(now, no_link);
    if (no_link) return now;
    now = next.is_absolute() ? next : now.parent_path() / next;
  }
  throw IoError(path.string() + ": cannot be written: " + std::generic_category().message(ELOOP));
}

void remove_temporary_files() noexcept {
  for (const auto& slot : temporary_names)
    if (const char* const name = slot.load()) ::unlink(name);
}

OutputFile::OutputFile(const std::filesystem::path& target)
    : target_(target), replaced_(target), slot_(kMostListed) {
  struct stat info {};
  const bool to_stdout = is_standard_output(target);
  const bool exists = !to_stdout && ::stat(target.c_str(), &info) == 0;
  if (!to_stdout && !exists && errno != ENOENT) fail(errno);
  if (exists && S_ISDIR(info.st_mode)) fail(EISDIR);
  if (exists && ::access(target.c_str(), W_OK) != 0) fail(errno);
  const bool direct = to_stdout || (exists && !S_ISREG(info.st_mode));
  if (!direct) replaced_ = link_target(target);
  const int descriptor = to_stdout ? ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0)
                         : direct  ? ::open(target.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY)
                                   : open_beside();
  if (descriptor < 0) fail(errno);
  // Permissions that cannot be taken over (a file of another owner) are no reason to lose the mesh.
  if (exists && !direct) static_cast<void>(::fchmod(descriptor, info.st_mode & 07777));
  file_ = ::fdopen(descriptor, "wb");
  if (!file_) {
    const int error = errno;
    ::close(descriptor);
    remove_temporary();
    fail(error);
  }
  std::setvbuf(file_, nullptr, _IONBF, 0);  // ByteSink has the buffer
}

OutputFile::~OutputFile() {
  if (file_) std::fclose(file_);
  if (!committed_) remove_temporary();
}

/// Opens a new file beside the target, which remove_temporary_files() knows before it is there. The mode is
/// the usual one of new files, 0666 less the umask, which mkstemp would not give.
int OutputFile::open_beside() {
  constexpr int kAttempts = 100;
  for (int attempt = 0;; ++attempt) {
    temporary_ = replaced_.parent_path() / temporary_name(replaced_);
    slot_ = list_temporary(temporary_.c_str());
    const int descriptor = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) return descriptor;
    const int error = errno;
    if (slot_ < kMostListed) temporary_names[slot_] = nullptr;
    temporary_.clear();
    errno = error;
    if (error != EEXIST || attempt == kAttempts) return -1;
  }
}

void OutputFile::remove_temporary() {
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  if (slot_ < kMostListed) temporary_names[slot_] = nullptr;
  temporary_.clear();
}

void OutputFile::fail(int error) {
  throw IoError(target_.string() + ": cannot be written: " + std::generic_category().message(error));
}

void OutputFile::put(std::string_view bytes) {
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail(errno ? errno : EIO);
}

void OutputFile::finish() {
  if (!file_) return;
  flush();
  errno = 0;
  // A device or pipe cannot be synced, and need not be.
  if (!temporary_.empty() && ::fsync(::fileno(file_)) != 0) fail(errno);
  std::FILE* const file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) fail(errno);
}

void OutputFile::commit() {
  finish();
  errno = 0;
  if (!temporary_.empty() && std::rename(temporary_.c_str(), replaced_.c_str()) != 0) fail(errno);
  committed_ = true;
  if (slot_ < kMostListed) temporary_names[slot_] = nullptr;
}

void commit_together(std::initializer_list<OutputFile*> files) {
  for (OutputFile* file : files)
    if (file) file->finish();
  for (OutputFile* file : files)
    if (file) file->commit();
}

std::string xml_escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return result;
}

}  // namespace hfr::io
