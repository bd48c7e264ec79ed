// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_PATHS_HH
#define HFR_APPS_PATHS_HH

#include <string>
#include <vector>

#include "Options.hh"
#include "hfremesh/IO/MeshFile.hh"

/// What can be known of files before any of them is read.
namespace hfr::app {

/// A file that a command reads or writes.
struct FileUse {
  enum class Kind { kInput, kMesh, kReport };
  Kind kind;
  std::string option;   ///< as messages call it
  std::string path;     ///< as given; "-" is a standard stream, empty is no file
  bool is_used = true;  ///< false where this run does not come to it
};

/// Fails, with exit code 1, where two of these are one file (the mesh that is written may be the one that was
/// read), where a standard stream is named twice, or a format for none.
void require_apart(const std::vector<FileUse>& uses, const CommonOptions& common);

/// Fails where a file could not be written there: the folder, the name and the permissions are tried with a
/// temporary file.
void require_writable(const std::string& path);

/// The same for a mesh, and its format and variant, which it returns with `options`.
io::WriteOptions require_writable_mesh(const std::string& path, const io::WriteOptions& options,
                                       const CommonOptions& common);

/// One line when the file that will be replaced goes by other names too, which keep the old one.
std::vector<std::string> notes_on_replacing(const std::string& path);

/// What the library calls the file.
std::string input_path(const std::string& path);
std::string output_path(const std::string& path);

}  // namespace hfr::app

#endif
