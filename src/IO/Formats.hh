// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_FORMATS_HH
#define HFR_IO_FORMATS_HH

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "IO/InputFile.hh"
#include "IO/MeshData.hh"
#include "IO/MeshFile.hh"

/// One reader and one writer a format; read_mesh and write_mesh choose among them. A reader parses and checks
/// what it needs to stay inside its arrays; the rest (finite coordinates, indices in range, lengths) is
/// checked by validate() after every reader, so that the messages are the same for all formats. A writer may
/// take a valid mesh for granted, and returns one line for each thing that the format cannot hold.
namespace hfr::io {

using Notes = std::vector<std::string>;

MeshData read_medit(const InputFile& file);   ///< .mesh, ASCII, with the .sol beside it
MeshData read_meditb(const InputFile& file);  ///< .meshb, binary, with the .solb or .sol beside it
MeshData read_tetgen(const InputFile& file);  ///< .node, .ele or .face: finds the others by their names
MeshData read_ovm(const InputFile& file);     ///< OpenVolumeMesh ASCII
MeshData read_gmsh(const InputFile& file);    ///< .msh 2.2, 4.0, 4.1, ASCII and binary
MeshData read_vtk(const InputFile& file);     ///< legacy .vtk, ASCII and binary
MeshData read_vtu(const InputFile& file);

Notes write_medit(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options);
Notes write_meditb(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options);
Notes write_tetgen(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options);
Notes write_ovm(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options);
Notes write_gmsh(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options);
Notes write_vtk(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options);
Notes write_vtu(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options);

/// .stl .obj .off .ply: triangles only; the mesh has no cells.
MeshData read_surface(const InputFile& file);
/// The boundary of the cells, outwards, or the triangles of the mesh where it has no cells.
Notes write_surface(const std::filesystem::path& path, const MeshData& mesh, const WriteOptions& options);

/// Another file of the same mesh: `path` itself where it has that extension, in capitals where `path`'s is.
std::filesystem::path file_beside(const std::filesystem::path& path, std::string_view extension);

}  // namespace hfr::io

#endif
