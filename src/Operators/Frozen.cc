// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Operator.hh"

namespace hfr {

std::vector<std::uint8_t> frozen_vertices(const TetMesh& mesh, par::Policy policy) {
  const std::size_t n = mesh.n_vertices();
  std::vector<std::uint8_t> frozen(n, 0);
  par::for_each(policy, n, [&](std::size_t i) {
    if (mesh.is_fixed(VertexHandle(i))) frozen[i] = 1;
  });
  // Serial: boundary faces are few, and each writes three vertices that it shares with others. The same sweep
  // counts the cells of each vertex, which tells a star that falls into parts.
  std::vector<std::uint32_t> n_cells(n, 0);
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    const CellHandle c(i);
    if (mesh.is_deleted(c)) continue;
    for (VertexHandle v : mesh.cell(c).v) ++n_cells[v.idx()];
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (m.is_valid() && (!mesh.has_regions() || mesh.region(c) == mesh.region(cell_of(m)))) continue;
      for (VertexHandle v : mesh.halfface_vertices(h)) frozen[v.idx()] = 1;
    }
  }
  for (const auto& face : mesh.labels().faces.entries())
    for (VertexHandle v : face.vertices) frozen[v.idx()] = 1;
  for (const auto& edge : mesh.labels().edges.entries())
    for (VertexHandle v : edge.vertices) frozen[v.idx()] = 1;
  par::for_ranges(policy, n, [&](std::size_t begin, std::size_t end) {
    Star star;
    for (std::size_t i = begin; i < end; ++i) {
      if (frozen[i] || n_cells[i] == 0) continue;
      if (!mesh.gather_star(VertexHandle(i), star) || static_cast<std::uint32_t>(star.size) != n_cells[i])
        frozen[i] = 1;
    }
  });
  return frozen;
}

}  // namespace hfr
