// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_TUPLE_USE_HH
#define HFR_HALFFACE_TUPLE_USE_HH

#include <cstdint>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/HalfFace/TupleMap.hh"

namespace hfr {

/// Per entry of an edge map (N = 2) or face map (N = 3): 1 when a cell of the mesh has that edge or face. One
/// pass over the cells, hashing only tuples of vertices that all occur in the map; so it does not depend on
/// incident cells or mates being right.
template <std::size_t N, class T, class Order>
std::vector<std::uint8_t> used_entries(const TetMesh& mesh, const TupleMap<N, T, Order>& map) {
  static_assert(N == 2 || N == 3);
  std::vector<std::uint8_t> used(map.size(), 0);
  std::vector<std::uint8_t> occurs(mesh.n_vertices(), 0);
  for (const auto& entry : map.entries())
    for (VertexHandle v : entry.vertices)
      if (v.idx() < occurs.size()) occurs[v.idx()] = 1;
  const auto mark = [&](const std::array<VertexHandle, N>& vertices) {
    const std::size_t at = map.position(vertices);
    if (at < used.size()) used[at] = 1;
  };
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    const CellHandle c(i);
    if (mesh.is_deleted(c)) continue;
    const auto& v = mesh.cell(c).v;
    std::array<bool, 4> here;
    for (std::size_t k = 0; k < 4; ++k) here[k] = occurs[v[k].idx()] != 0;
    if constexpr (N == 2) {
      for (const auto& e : kEdgeCorners) {
        if (!here[e[0]] || !here[e[1]]) continue;
        mark({v[e[0]], v[e[1]]});
        if constexpr (Order::kDirected) mark({v[e[1]], v[e[0]]});
      }
    } else {
      for (const auto& f : kFaceCorners)
        if (here[f[0]] && here[f[1]] && here[f[2]]) mark({v[f[0]], v[f[1]], v[f[2]]});
    }
  }
  return used;
}

}  // namespace hfr

#endif
