// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_MESH_FILE_HH
#define HFR_IO_MESH_FILE_HH

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hfremesh/IO/MeshData.hh"

namespace hfr::io {

/// What the standard input of the process is called as a file, and its standard output as a target; they are
/// read and written as they were opened.
inline constexpr const char* kStandardInput = "/dev/stdin";
inline constexpr const char* kStandardOutput = "/dev/stdout";

/// How a file is to be written.
struct WriteOptions {
  bool binary = false;  ///< .msh .vtk .stl .ply: binary variant; .vtu goes by variant alone
  std::string variant =
      {};  ///< format's own name for a version: msh "2.2" | "4.0" | "4.1"; vtk "4.2" | "5.1";
           ///< vtu "ascii" | "base64" | "appended" | "zlib"; the other formats have none
  std::string format =
      {};  ///< extension that stands for the format, "vtu" or ".vtu"; empty: that of the path
};

/// Reads a mesh of any known format, chosen by extension (or by `format`, as in WriteOptions) and, where
/// extensions collide, by content. kStandardInput is read to its end; a format of several files cannot come
/// that way. Throws IoError when the file cannot be opened, InvalidInput with "FILE:LINE: …" (text) or "FILE:
/// at byte N: …" (binary) when what it says is broken or not supported.
MeshData read_mesh(const std::filesystem::path& path, const std::string& format = {});

/// Writes to a temporary file beside `path`, then renames it; kStandardOutput is written to as it is. Returns
/// one line for each thing that the format cannot hold (names, fields, labels). Throws IoError; a failed
/// write leaves no file behind.
std::vector<std::string> write_mesh(const std::filesystem::path& path, const MeshData& mesh,
                                    const WriteOptions& options = {});

/// What read_mesh() and write_mesh() would refuse whatever the mesh: throws InvalidInput for a format that is
/// not known, that is made of several files while the path is a standard stream, or has no such variant.
void require_readable_format(const std::filesystem::path& path, const std::string& format = {});
void require_writable_format(const std::filesystem::path& path, const WriteOptions& options);

/// Whether fields on vertices and cells find a place in what write_mesh() makes there. Throws InvalidInput
/// for a format that is not known.
bool holds_fields(const std::filesystem::path& path, const WriteOptions& options);

/// The files that a mesh of this path is or may be made of, the path itself first: TetGen's four, Medit's
/// with its solutions, or one.
std::vector<std::filesystem::path> files_of_mesh(const std::filesystem::path& path);

/// Extensions that read_mesh / write_mesh know, with the dot.
std::vector<std::string> readable_extensions();
std::vector<std::string> writable_extensions();

}  // namespace hfr::io

#endif
