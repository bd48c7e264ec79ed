// SPDX-License-Identifier: BSD-3-Clause
#include "Files.hh"

#include <set>

#include "Console.hh"
#include "ExitCode.hh"
#include "Paths.hh"
#include "hfremesh/HalfFace/Check.hh"
#include "hfremesh/IO/Assemble.hh"
#include "hfremesh/IO/OutputFile.hh"

namespace hfr::app {
namespace {

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

io::MeshData read_data(const std::string& path, const CommonOptions& common) {
  if (path == "-" && common.format.empty())
    throw Failure(ExitCode::kUsage, "-: name the format of the mesh with --format");
  const std::string file = input_path(path);
  return reading(file, [&] { return io::read_mesh(file, path == "-" ? common.format : ""); });
}

LoadedMesh load(const std::string& path, const CommonOptions& common) {
  const Stopwatch read;
  io::MeshData data = read_data(path, common);
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
  loaded.mesh = reading(path, [&] {
    return io::assemble(std::move(data), common.policy(), &loaded.report, &loaded.notes,
                        common.split_nonmanifold ? NonManifold::kSplit : NonManifold::kKeep);
  });
  loaded.seconds_build = build.seconds();
  if (loaded.report.flipped)
    loaded.notes.push_back(path + " orders all cells the other way round; they were flipped as a whole");
  if (!loaded.report.reoriented.empty())
    loaded.notes.push_back(std::to_string(loaded.report.reoriented.size()) + " cells of " + path +
                           " contradicted their neighbours' order and were turned");
  if (!loaded.report.copied.empty()) {
    std::set<VertexHandle> split(loaded.report.copied.begin(), loaded.report.copied.end());
    loaded.notes.push_back(std::to_string(split.size()) + " vertices of " + path +
                           " joined cells that no face connects and were split: " +
                           std::to_string(loaded.report.copied.size()) + " vertices are new");
  }
  return loaded;
}

void require_sound(const TetMesh& mesh, const std::string& input, const CommonOptions& common) {
  const CheckOptions options = {.last = Rule::kDuplicateEdge, .policy = common.policy()};
  const CheckResult found = check(mesh, options);
  if (found) return;
  const bool may_be_the_input = found == Rule::kDuplicateEdge && input != "-";
  if (may_be_the_input && check(load(input, common).mesh, options) == Rule::kDuplicateEdge) return;
  throw Failure(ExitCode::kInternal, "internal error, worth a report: the mesh that was made of " + input +
                                         " breaks a rule, and nothing was written: " + found.message);
}

std::vector<std::string> save(const std::string& path, const io::MeshData& data,
                              const io::WriteOptions& options) {
  return writing(path, [&] { return io::write_mesh(output_path(path), data, options); });
}

ExitCode without_report(const std::exception& error, ExitCode code) {
  print_error(message_of(error));
  return code == ExitCode::kDone ? ExitCode::kUsage : code;
}

ExitCode save_report(const std::string& path, const std::function<std::string()>& text, ExitCode code) {
  try {
    if (path == "-") {
      put_out(text());  // whether it arrives is asked in the end
      return code;
    }
    io::OutputFile file(path);
    file.text(text());
    file.commit();
    return code;
  } catch (const std::exception& error) {
    return without_report(error, code);
  }
}

}  // namespace hfr::app
