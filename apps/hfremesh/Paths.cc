// SPDX-License-Identifier: BSD-3-Clause
#include "Paths.hh"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <system_error>

#include "ExitCode.hh"
#include "hfremesh/HalfFace/Errors.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/IO/OutputFile.hh"

namespace hfr::app {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& message) { throw Failure(ExitCode::kUsage, message); }

std::optional<struct stat> status_of(const fs::path& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return std::nullopt;
  return info;
}

/// Where a file that is not there yet would be made.
fs::path place_of(const fs::path& path) {
  try {
    const fs::path target = io::link_target(path);
    const fs::path folder = target.parent_path();
    std::error_code ignored;
    return fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, ignored) / target.filename();
  } catch (const IoError& error) {  // links in a circle
    refuse(error.what());
  }
}

/// Pipes and devices may be shared: nothing in them is replaced.
bool are_one_file(const fs::path& a, const fs::path& b) {
  const auto at_a = status_of(a);
  const auto at_b = status_of(b);
  if (at_a && at_b)
    return S_ISREG(at_a->st_mode) && at_a->st_dev == at_b->st_dev && at_a->st_ino == at_b->st_ino;
  return !at_a && !at_b && place_of(a) == place_of(b);
}

/// All files that may be read or written for this one.
std::vector<fs::path> files_of(const FileUse& use) {
  if (use.kind == FileUse::Kind::kReport) return {use.path};
  return io::files_of_mesh(use.path);
}

void require_apart(const FileUse& a, const FileUse& b) {
  using Kind = FileUse::Kind;
  if (a.kind == Kind::kInput && b.kind != Kind::kReport) return;  // read twice, or replaced in the end
  for (const fs::path& one : files_of(a))
    for (const fs::path& other : files_of(b))
      if (are_one_file(one, other))
        refuse(a.option + " and " + b.option + " are the same file, " + one.string() + ": name another one");
}

/// A report that the shell sends into a file must not land in one that is replaced.
void require_apart_from_stdout(const FileUse& use) {
  struct stat out {};
  if (use.kind == FileUse::Kind::kInput || fstat(STDOUT_FILENO, &out) != 0 || !S_ISREG(out.st_mode)) return;
  for (const fs::path& path : files_of(use)) {
    const auto info = status_of(path);
    if (info && info->st_dev == out.st_dev && info->st_ino == out.st_ino)
      refuse("the standard output and " + use.option + " are the same file, " + path.string() +
             ": name another one");
  }
}

bool is_stream(const FileUse& use) { return use.path == "-"; }

}  // namespace

void require_apart(const std::vector<FileUse>& all, const CommonOptions& common) {
  const FileUse* from_stdin = nullptr;
  const FileUse* to_stdout = nullptr;
  std::vector<FileUse> files;
  for (const FileUse& use : all) {
    if (!use.path.empty() && !is_stream(use)) files.push_back(use);
    if (!is_stream(use)) continue;
    const FileUse*& user = use.kind == FileUse::Kind::kInput ? from_stdin : to_stdout;
    if (user)
      refuse(user->option + " and " + use.option + " cannot both be -, the standard " +
             (use.kind == FileUse::Kind::kInput ? "input" : "output"));
    user = &use;
  }
  const bool streams_a_mesh = from_stdin || (to_stdout && to_stdout->kind == FileUse::Kind::kMesh);
  if (!streams_a_mesh && !(common.format + common.output_format).empty())
    refuse("--format is for a mesh on -, a standard stream; files go by their extension");
  if (from_stdin && isatty(STDIN_FILENO) == 1) refuse("-: the standard input is a terminal, not a mesh");
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t k = i + 1; k < files.size(); ++k) require_apart(files[i], files[k]);
    require_apart_from_stdout(files[i]);
  }
}

void require_writable(const std::string& path) {
  if (path == "-") return;  // a report that is lost there costs no mesh
  const fs::path target(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code ignored;
  if (fs::is_directory(target, ignored)) refuse(path + ": cannot be written: it is a folder");
  if (!fs::exists(folder, ignored) || !fs::is_directory(folder, ignored))
    refuse(path + ": cannot be written: there is no folder " + folder.string());
  const auto info = status_of(target);
  if (info && !S_ISREG(info->st_mode)) {  // to open a pipe is to wait for its reader
    if (access(path.c_str(), W_OK) != 0) refuse(path + ": cannot be written: no permission");
    return;
  }
  try {
    io::OutputFile probe(target);
  } catch (const IoError& error) {
    refuse(error.what());
  }
}

io::WriteOptions require_writable_mesh(const std::string& path, const io::WriteOptions& options,
                                       const CommonOptions& common) {
  io::WriteOptions chosen = options;
  if (path == "-") chosen.format = common.output_format.empty() ? common.format : common.output_format;
  if (path == "-" && chosen.format.empty()) refuse("-: name the format of the mesh with --format");
  const int mode = path == "-" ? fcntl(STDOUT_FILENO, F_GETFL) : O_WRONLY;
  if (mode < 0 || (mode & O_ACCMODE) == O_RDONLY) refuse("-: the standard output is closed");
  try {
    io::require_writable_format(output_path(path), chosen);
  } catch (const InvalidInput& error) {
    refuse(error.what());
  }
  require_writable(path);
  return chosen;
}

std::vector<std::string> notes_on_replacing(const std::string& path) {
  const auto info = path == "-" ? std::nullopt : status_of(path);
  if (!info || !S_ISREG(info->st_mode) || info->st_nlink < 2) return {};
  return {path + " has other names (hard links), which keep the old file"};
}

std::string input_path(const std::string& path) { return path == "-" ? io::kStandardInput : path; }

std::string output_path(const std::string& path) { return path == "-" ? io::kStandardOutput : path; }

}  // namespace hfr::app
