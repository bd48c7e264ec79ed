// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_READ_WRITE_HH
#define HFR_IO_READ_WRITE_HH

#include <filesystem>
#include <string>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/IO/MeshFile.hh"
#include "hfremesh/Parallel/Parallel.hh"

/// From file to mesh and back in one call each. Who wants the arrays in between takes read_mesh() and
/// assemble(), disassemble() and write_mesh().
namespace hfr::io {

/// What is worth telling the user about a file that was read.
struct ReadReport {
  BuildReport build;               ///< what had to be turned to make the cells agree
  std::vector<std::string> notes;  ///< one line each: what was linearised, skipped or could not be kept
};

/// Reads a mesh of any known format with all that the file says of it: regions (TetMesh::region()), labels of
/// triangles, edges and vertices and the names of labels (TetMesh::labels()), fixed vertices, and fields as
/// properties of vertices and cells, under their names (see FieldLayout.hh for their types). Handles
/// equal the indices of the file. Throws IoError when the file cannot be opened, InvalidInput, with the path,
/// when what it says is broken or it has no tetrahedra, ResourceLimit for more cells than an index counts.
TetMesh read(const std::filesystem::path& path, par::Policy policy = {}, ReadReport* report = nullptr);

/// Writes the mesh with all of that, whole or not at all; the format is chosen by the extension. Deleted
/// things are left out; locks of edges, faces and patches and anonymous properties are in no file. Returns
/// one line for each thing that the format cannot hold. Throws IoError when the file cannot be written,
/// InvalidInput for an unknown extension.
std::vector<std::string> write(const std::filesystem::path& path, const TetMesh& mesh,
                               const WriteOptions& options = {}, par::Policy policy = {});

}  // namespace hfr::io

#endif
