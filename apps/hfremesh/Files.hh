// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_FILES_HH
#define HFR_APPS_FILES_HH

#include <string>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "IO/MeshData.hh"
#include "IO/MeshFile.hh"
#include "Options.hh"

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

io::MeshData read_data(const std::string& path);
LoadedMesh load(const std::string& path, const CommonOptions& common);
/// The same from what read_data() gave for `path`.
LoadedMesh load(io::MeshData data, const std::string& path, const CommonOptions& common);

/// Fails unless the file type is known and the folder is there and takes files: said before the work, not
/// after.
void require_writable_mesh(const std::string& path);
void require_writable_folder(const std::string& path);

/// Returns the writer's notes.
std::vector<std::string> save(const std::string& path, const io::MeshData& data,
                              const io::WriteOptions& options);

/// Whole or not at all; "-" is stdout.
void save_text(const std::string& path, const std::string& text);

}  // namespace hfr::app

#endif
