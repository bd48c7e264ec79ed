// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_MEDIT_PART_HH
#define HFR_IO_MEDIT_PART_HH

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "IO/ByteSink.hh"
#include "IO/MeshData.hh"

/// Distributed meshes in the layout of ParMmg: for each part a Medit file as text, which also says what the
/// part shares with others (sections NumberOfPartitions, ParallelTriangleCommunicators,
/// ParallelCommunicatorTriangles, and the same with Vertex and Vertices).
namespace hfr::io {

/// What a part shares with another one, which has the same with the same numbers.
struct MeditInterface {
  int part = 0;                      ///< the other one
  std::vector<Index> items;          ///< vertices, or triangles, of this part
  std::vector<std::int64_t> number;  ///< of each
};

struct MeditPart {
  MeshData mesh;
  std::int64_t n_parts = 0;   ///< 0 where the file does not say
  bool by_triangles = false;  ///< what the interfaces are made of; otherwise of vertices
  std::vector<MeditInterface> interfaces;
  /// What the file lists as parallel, that is between parts.
  std::vector<Index> parallel_triangles, parallel_edges;
};

/// The file of a part: "name.7.mesh" for "name.mesh".
std::filesystem::path medit_part_path(const std::filesystem::path& path, int part);

/// What is required and parallel at the same time is not fixed, since ParMmg requires all that is parallel.
/// Where there are interfaces of both kinds, those of triangles count, as they do for ParMmg. Throws IoError
/// when the file cannot be opened, InvalidInput, with file and line, when what it says is broken, when it has
/// elements of second order, and when it is cut short.
MeditPart read_medit_part(const std::filesystem::path& path);
/// Returns one line for each thing that the format cannot hold.
std::vector<std::string> write_medit_part(ByteSink& file, const MeditPart& part);

}  // namespace hfr::io

#endif
