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
  return mesh.get_cell_property<std::uint64_t>(kName).has_value();
}

namespace detail {

inline auto numbers(auto& mesh, VertexHandle) {
  return mesh.template get_vertex_property<std::uint64_t>(kName);
}
inline auto numbers(auto& mesh, CellHandle) { return mesh.template get_cell_property<std::uint64_t>(kName); }

}  // namespace detail

/// Of a vertex or a cell; 0 where none are followed.
template <class Handle>
std::uint64_t of(const TetMesh& mesh, Handle h) {
  if (mesh.properties().cells.empty()) return 0;  // as most are
  const auto numbers = detail::numbers(mesh, h);
  return numbers ? (*numbers)[h] : 0;
}
/// Nothing is done where none are followed.
template <class Handle>
void set(TetMesh& mesh, Handle h, std::uint64_t number) {
  if (mesh.properties().cells.empty()) return;
  if (auto numbers = detail::numbers(mesh, h)) (*numbers)[h] = number;
}

}  // namespace hfr::mpi::sources

#endif
