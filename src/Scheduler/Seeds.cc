// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/Seeds.hh"

#include <algorithm>

#include "Operators/Operator.hh"

namespace hfr {
namespace {

constexpr std::size_t kVerticesASortedCell = 512;

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
  std::vector<VertexHandle> vertices;
  // A few cells sort their vertices; many are cheaper to serve by one look at every vertex of the mesh.
  if (list.cells().size() < mesh.n_vertices() / kVerticesASortedCell) {
    for (Index c : list.cells())
      for (VertexHandle v : mesh.cell(CellHandle(c)).v)
        if (!frozen[v.idx()]) vertices.push_back(v);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }
  std::vector<std::uint8_t> listed(mesh.n_vertices(), 0);
  for (Index c : list.cells())
    for (VertexHandle v : mesh.cell(CellHandle(c)).v) listed[v.idx()] = 1;
  const auto indices =
      par::compact<Index>(policy, mesh.n_vertices(), [&](std::size_t i) { return listed[i] && !frozen[i]; });
  vertices.resize(indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) vertices[i] = VertexHandle(indices[i]);
  return vertices;
}

void drop_pinched(const TetMesh& mesh, const Workspace& work, std::vector<VertexHandle>& vertices) {
  Star scratch;
  std::erase_if(vertices, [&](VertexHandle v) {
    const std::uint32_t size = work.star_size[v.idx()];
    if (size > Star::kCapacity) return true;
    // Rounds make none, so no other star has to be walked.
    return !work.pinched.empty() && work.pinched[v.idx()] && is_pinched(mesh, v, size, scratch);
  });
}

}  // namespace hfr
