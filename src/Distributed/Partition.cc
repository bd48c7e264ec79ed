// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Partition.hh"

#include <algorithm>
#include <numeric>

#include "Distributed/PartitionGraph.hh"

namespace hfr::mpi {
namespace {

/// Owners [first, first + n) of the listed vertices, in halves by the longest side.
void halve(const TetMesh& mesh, std::span<Index> vertices, int first, int n, std::vector<int>& owner) {
  if (n == 1 || vertices.empty()) {
    for (Index v : vertices) owner[v] = first;
    return;
  }
  Vec3 low = mesh.points()[vertices[0]], high = low;
  for (Index v : vertices)
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], mesh.points()[v][d]);
      high[d] = std::max(high[d], mesh.points()[v][d]);
    }
  int axis = 0;
  for (int d = 1; d < 3; ++d)
    if (high[d] - low[d] > high[axis] - low[axis]) axis = d;
  const std::size_t middle = vertices.size() * static_cast<std::size_t>(n / 2) / static_cast<std::size_t>(n);
  std::nth_element(vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(middle), vertices.end(),
                   [&](Index a, Index b) {
                     const double x = mesh.points()[a][axis], y = mesh.points()[b][axis];
                     return x < y || (x == y && a < b);
                   });
  halve(mesh, vertices.first(middle), first, n / 2, owner);
  halve(mesh, vertices.subspan(middle), first + n / 2, n - n / 2, owner);
}

std::vector<int> by_coordinates(const TetMesh& mesh, int n_ranks) {
  std::vector<int> owner(mesh.n_vertices(), 0);
  std::vector<Index> vertices(mesh.n_vertices());
  std::iota(vertices.begin(), vertices.end(), Index{0});
  halve(mesh, vertices, 0, n_ranks, owner);
  return owner;
}

std::vector<int> by_numbers(const TetMesh& mesh, int n_ranks) {
  std::vector<int> owner(mesh.n_vertices(), 0);
  for (std::size_t v = 0; v < owner.size(); ++v)
    owner[v] = static_cast<int>(v * static_cast<std::size_t>(n_ranks) / owner.size());
  return owner;
}

/// Empty where a rank would be left without a vertex.
std::vector<int> by_smallest_cell(const TetMesh& mesh, std::span<const int> part, int n_ranks) {
  std::vector<int> owner(mesh.n_vertices(), 0);
  for (std::size_t c = part.size(); c-- > 0;)
    if (!mesh.is_deleted(CellHandle(c)))
      for (VertexHandle v : mesh.cell(CellHandle(c)).v) owner[v.idx()] = part[c];
  std::vector<std::uint8_t> has(static_cast<std::size_t>(n_ranks), 0);
  for (int r : owner) has[static_cast<std::size_t>(r)] = 1;
  if (std::count(has.begin(), has.end(), 1) != n_ranks) owner.clear();
  return owner;
}

}  // namespace

std::vector<int> partition(Comm& comm, const TetMesh* mesh, Partition how) {
  if (how == Partition::kGraph && comm.size() > 1) {
    const std::vector<int> part = parts_of_cells(comm, mesh);
    if (!mesh) return {};
    std::vector<int> owner;
    if (!part.empty()) owner = by_smallest_cell(*mesh, part, comm.size());
    return owner.empty() ? by_coordinates(*mesh, comm.size()) : owner;
  }
  if (!mesh) return {};
  return how == Partition::kNumbers ? by_numbers(*mesh, comm.size()) : by_coordinates(*mesh, comm.size());
}

}  // namespace hfr::mpi
