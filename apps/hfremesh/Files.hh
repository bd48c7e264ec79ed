// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_FILES_HH
#define HFR_APPS_FILES_HH

#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "ExitCode.hh"
#include "Options.hh"
#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/IO/MeshData.hh"
#include "hfremesh/IO/MeshFile.hh"

/// Reading and writing with the tool's exit codes: what is wrong with an input is a Failure of code 2, an
/// output that cannot be written one of code 1.
namespace hfr::app {

struct LoadedMesh {
  TetMesh mesh;
  BuildReport report;
  std::vector<std::string> notes;
  double seconds_read = 0;
  double seconds_build = 0;
};

/// "-" is stdin, in the format that the options name.
io::MeshData read_data(const std::string& path, const CommonOptions& common);
LoadedMesh load(const std::string& path, const CommonOptions& common);
/// The same from what read_data() gave for `path`.
LoadedMesh load(io::MeshData data, const std::string& path, const CommonOptions& common);

/// Fails with exit code 7 when a mesh that was made of the file breaks a rule of the library, which then is
/// at fault; what was made must not take the place of the user's file. An edge that exists twice may stay
/// where the file has such an edge too.
void require_sound(const TetMesh& mesh, const std::string& input, const CommonOptions& common);

/// Returns the writer's notes; `options` as require_writable_mesh() returned them.
std::vector<std::string> save(const std::string& path, const io::MeshData& data,
                              const io::WriteOptions& options);

/// A report, whole or not at all; "-" is stdout. The mesh is written by then, so one that is lost costs a
/// line and turns exit code 0 into 1, but no other: those say more. Returns the code to end with. `text`
/// makes it; what that throws loses it as well.
ExitCode save_report(const std::string& path, const std::function<std::string()>& text, ExitCode code);
/// The same of a report that could not be made.
ExitCode without_report(const std::exception& error, ExitCode code);

}  // namespace hfr::app

#endif
