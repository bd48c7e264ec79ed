// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_MESH_FILE_HH
#define HFR_IO_MESH_FILE_HH

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "IO/MeshData.hh"

namespace hfr::io {

/// How a file is to be written; formats that have no choice ignore it.
struct WriteOptions {
  bool binary = false;  ///< .msh .vtk .vtu: binary variant; .mesh is always ASCII, .meshb always binary
  std::string variant;  ///< format's own name for a version: msh "2.2" | "4.0" | "4.1"; vtk "4.2" | "5.1";
                        ///< vtu "ascii" | "base64" | "appended" | "zlib"
};

/// Reads a mesh of any known format, chosen by extension and, where extensions collide, by content.
/// Throws IoError when the file cannot be opened, InvalidInput with "FILE:LINE: …" (text) or "FILE: at byte
/// N: …" (binary) when what it says is broken or not supported.
MeshData read_mesh(const std::filesystem::path& path);

/// Writes to a temporary file beside `path`, then renames it. Returns one line for each thing that the format
/// cannot hold (names, fields, labels). Throws IoError; a failed write leaves no file behind.
std::vector<std::string> write_mesh(const std::filesystem::path& path, const MeshData& mesh,
                                    const WriteOptions& options = {});

/// Extensions that read_mesh / write_mesh know, with the dot.
std::vector<std::string> readable_extensions();
std::vector<std::string> writable_extensions();

}  // namespace hfr::io

#endif
