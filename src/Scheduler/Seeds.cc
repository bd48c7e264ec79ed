// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/Seeds.hh"

#include "Operators/Operator.hh"

namespace hfr {
namespace {

/// Concatenates emit(cell, out) over the listed cells, in their order.
template <class Seed, class Emit>
std::vector<Seed> gather(const Worklist& list, par::Policy policy, Emit&& emit) {
  const auto cells = list.cells();
  const int n_parts = par::thread_count(policy, cells.size());
  std::vector<std::vector<Seed>> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    auto& mine = found[static_cast<std::size_t>(part)];
    const std::size_t end = par::part_begin(cells.size(), n_parts, part + 1);
    for (std::size_t i = par::part_begin(cells.size(), n_parts, part); i < end; ++i)
      emit(CellHandle(cells[i]), mine);
  });
  if (n_parts == 1) return std::move(found[0]);
  std::vector<Seed> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

std::vector<EdgeHandle> edge_seeds(const TetMesh& mesh, const Worklist& list, par::Policy policy) {
  return gather<EdgeHandle>(list, policy, [&](CellHandle c, std::vector<EdgeHandle>& out) {
    visit_edge_seeds(mesh, list, c, [&](EdgeHandle e) { out.push_back(e); });
  });
}

std::vector<HalfFaceHandle> face_seeds(const TetMesh& mesh, const Worklist& list, par::Policy policy) {
  return gather<HalfFaceHandle>(list, policy, [&](CellHandle c, std::vector<HalfFaceHandle>& out) {
    visit_face_seeds(mesh, list, c, [&](HalfFaceHandle h) { out.push_back(h); });
  });
}

std::vector<VertexHandle> vertex_seeds(const TetMesh& mesh, const Worklist& list,
                                       std::span<const std::uint8_t> frozen, par::Policy policy) {
  std::vector<std::uint8_t> listed(mesh.n_vertices(), 0);
  for (Index c : list.cells())
    for (VertexHandle v : mesh.cell(CellHandle(c)).v) listed[v.idx()] = 1;
  const auto indices =
      par::compact<Index>(policy, mesh.n_vertices(), [&](std::size_t i) { return listed[i] && !frozen[i]; });
  std::vector<VertexHandle> vertices(indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) vertices[i] = VertexHandle(indices[i]);
  return vertices;
}

void drop_pinched(const TetMesh& mesh, std::span<const std::uint32_t> star_size,
                  std::vector<VertexHandle>& vertices, par::Policy policy) {
  std::vector<std::uint8_t> pinched(vertices.size(), 0);
  par::for_ranges(policy, vertices.size(), [&](std::size_t begin, std::size_t end) {
    Star scratch;
    for (std::size_t i = begin; i < end; ++i)
      pinched[i] = is_pinched(mesh, vertices[i], star_size[vertices[i].idx()], scratch);
  });
  std::size_t n = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (!pinched[i]) vertices[n++] = vertices[i];
  vertices.resize(n);
}

}  // namespace hfr
