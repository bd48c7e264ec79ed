// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_SOURCES_HH
#define HFR_DISTRIBUTED_SOURCES_HH

#include <cstdint>

#include "HalfFace/TetMesh.hh"

/// Values that are attached to vertices and cells, as hfr::improve() leaves them, without the values: each
/// vertex and each cell has the number of the one whose values it has. That is a property of the mesh, so
/// that operators hand it on as they hand on any other.
namespace hfr::mpi::sources {

inline constexpr const char* kName = "source";

/// Gives all vertices and cells such a number, which set() is to be told.
inline void follow(TetMesh& mesh) {
  mesh.request_vertex_property<std::uint64_t>(kName);
  mesh.request_cell_property<std::uint64_t>(kName);
}
inline bool are_followed(const TetMesh& mesh) {
  return !mesh.properties().cells.empty() && mesh.get_cell_property<std::uint64_t>(kName).has_value();
}

/// 0 where none are followed.
inline std::uint64_t of(const TetMesh& mesh, VertexHandle v) {
  return are_followed(mesh) ? (*mesh.get_vertex_property<std::uint64_t>(kName))[v] : 0;
}
inline std::uint64_t of(const TetMesh& mesh, CellHandle c) {
  return are_followed(mesh) ? (*mesh.get_cell_property<std::uint64_t>(kName))[c] : 0;
}
/// Nothing is done where none are followed.
inline void set(TetMesh& mesh, VertexHandle v, std::uint64_t number) {
  if (are_followed(mesh)) (*mesh.get_vertex_property<std::uint64_t>(kName))[v] = number;
}
inline void set(TetMesh& mesh, CellHandle c, std::uint64_t number) {
  if (are_followed(mesh)) (*mesh.get_cell_property<std::uint64_t>(kName))[c] = number;
}

}  // namespace hfr::mpi::sources

#endif
