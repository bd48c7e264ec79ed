// SPDX-License-Identifier: BSD-3-Clause
#include "Files.hh"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "Console.hh"
#include "ExitCode.hh"
#include "IO/Assemble.hh"
#include "IO/OutputFile.hh"

namespace hfr::app {
namespace {

namespace fs = std::filesystem;

/// Errors of the kernel do not know the file.
std::string with_file(const std::string& path, const std::string& message) {
  return message.rfind(path, 0) == 0 ? message : path + ": " + message;
}

/// Runs `read`; what the library finds wrong with the file becomes exit code 2.
template <class Read>
auto reading(const std::string& path, Read&& read) {
  try {
    return read();
  } catch (const InvalidInput& error) {
    throw Failure(ExitCode::kCannotRead, with_file(path, error.what()));
  } catch (const IoError& error) {
    throw Failure(ExitCode::kCannotRead, with_file(path, error.what()));
  }
}

template <class Write>
auto writing(const std::string& path, Write&& write) {
  try {
    return write();
  } catch (const InvalidInput& error) {
    throw Failure(ExitCode::kUsage, with_file(path, error.what()));
  } catch (const IoError& error) {
    throw Failure(ExitCode::kUsage, with_file(path, error.what()));
  }
}

}  // namespace

io::MeshData read_data(const std::string& path) {
  return reading(path, [&] { return io::read_mesh(path); });
}

LoadedMesh load(const std::string& path, const CommonOptions& common) {
  const Stopwatch read;
  io::MeshData data = read_data(path);
  const double seconds_read = read.seconds();
  LoadedMesh loaded = load(std::move(data), path, common);
  loaded.seconds_read = seconds_read;
  return loaded;
}

LoadedMesh load(io::MeshData data, const std::string& path, const CommonOptions& common) {
  LoadedMesh loaded;
  loaded.notes = std::move(data.notes);
  if (data.cells.empty())
    throw Failure(ExitCode::kCannotRead, path + ": there are no tetrahedra in the file");
  const Stopwatch build;
  loaded.mesh = reading(
      path, [&] { return io::assemble(std::move(data), common.policy(), &loaded.report, &loaded.notes); });
  loaded.seconds_build = build.seconds();
  if (loaded.report.flipped)
    loaded.notes.push_back(path + " orders all cells the other way round; they were flipped as a whole");
  if (!loaded.report.reoriented.empty())
    loaded.notes.push_back(std::to_string(loaded.report.reoriented.size()) + " cells of " + path +
                           " contradicted their neighbours' order and were turned");
  return loaded;
}

void require_writable_folder(const std::string& path) {
  const fs::path target(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code ignored;
  if (fs::is_directory(target, ignored))
    throw Failure(ExitCode::kUsage, path + ": cannot be written: it is a folder");
  if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored)) return;  // a pipe or device
  if (!fs::is_directory(folder, ignored))
    throw Failure(ExitCode::kUsage, path + ": cannot be written: there is no folder " + folder.string());
  if (access(folder.c_str(), W_OK) != 0)
    throw Failure(ExitCode::kUsage, path + ": cannot be written: no permission in folder " + folder.string());
}

void require_writable_mesh(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto known = io::writable_extensions();
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    std::string list;
    for (const std::string& name : known) list += " " + name;
    throw Failure(ExitCode::kUsage, path + ": unknown file type '" + extension + "'; known are" + list);
  }
  require_writable_folder(path);
}

std::vector<std::string> save(const std::string& path, const io::MeshData& data,
                              const io::WriteOptions& options) {
  return writing(path, [&] { return io::write_mesh(path, data, options); });
}

void save_text(const std::string& path, const std::string& text) {
  if (path == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
    return;
  }
  writing(path, [&] {
    io::OutputFile file(path);
    file.text(text);
    file.commit();
    return 0;
  });
}

}  // namespace hfr::app
