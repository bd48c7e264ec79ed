// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Operator.hh"

namespace hfr {

std::vector<std::uint32_t> star_sizes(const TetMesh& mesh) {
  std::vector<std::uint32_t> size(mesh.n_vertices(), 0);
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    if (mesh.is_deleted(CellHandle(i))) continue;
    for (VertexHandle v : mesh.cell(CellHandle(i)).v) ++size[v.idx()];
  }
  return size;
}

bool is_pinched(const TetMesh& mesh, VertexHandle v, std::uint32_t star_size, Star& scratch) {
  return !mesh.gather_star(v, scratch) || static_cast<std::uint32_t>(scratch.size) != star_size;
}

std::vector<std::uint8_t> constrained_vertices(const TetMesh& mesh, par::Policy policy) {
  std::vector<std::uint8_t> frozen(mesh.n_vertices(), 0);
  par::for_each(policy, frozen.size(), [&](std::size_t i) {
    if (mesh.is_fixed(VertexHandle(i))) frozen[i] = 1;
  });
  // Serial: boundary faces are few, and each writes three vertices that it shares with others.
  const bool one_region = !mesh.has_regions();
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    const CellHandle c(i);
    const auto& mate = mesh.cell(c).mate;
    if (one_region && mate[0].is_valid() && mate[1].is_valid() && mate[2].is_valid() && mate[3].is_valid())
      continue;
    if (mesh.is_deleted(c)) continue;
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (m.is_valid() && (one_region || mesh.region(c) == mesh.region(cell_of(m)))) continue;
      for (VertexHandle v : mesh.halfface_vertices(h)) frozen[v.idx()] = 1;
    }
  }
  for (const auto& face : mesh.labels().faces.entries())
    for (VertexHandle v : face.vertices) frozen[v.idx()] = 1;
  for (const auto& edge : mesh.labels().edges.entries())
    for (VertexHandle v : edge.vertices) frozen[v.idx()] = 1;
  for (const auto& face : mesh.locks().faces.entries())
    for (VertexHandle v : face.vertices) frozen[v.idx()] = 1;
  for (const auto& edge : mesh.locks().edges.entries())
    for (VertexHandle v : edge.vertices) frozen[v.idx()] = 1;
  return frozen;
}

std::vector<std::uint8_t> frozen_vertices(const TetMesh& mesh, par::Policy policy) {
  std::vector<std::uint8_t> frozen = constrained_vertices(mesh, policy);
  const std::vector<std::uint32_t> size = star_sizes(mesh);
  par::for_ranges(policy, frozen.size(), [&](std::size_t begin, std::size_t end) {
    Star star;
    for (std::size_t i = begin; i < end; ++i) {
      if (!frozen[i] && size[i] > 0 && is_pinched(mesh, VertexHandle(i), size[i], star)) frozen[i] = 1;
    }
  });
  return frozen;
}

}  // namespace hfr
