// SPDX-License-Identifier: BSD-3-Clause
// C. Chevalier, F. Pellegrini, PT-Scotch: a tool for efficient parallel graph ordering, Parallel Computing
// 34, 2008.
#include "Distributed/Partition.hh"

#include <cstdio>  // ptscotch.h names FILE

#include <ptscotch.h>

#include <algorithm>
#include <numeric>

namespace hfr::mpi {
namespace {

/// Rows of the graph of cells for one rank: neighbours through faces.
struct Rows {
  std::vector<SCOTCH_Num> begin = {0}, neighbours;
};

Rows rows_of(const TetMesh& mesh, std::size_t first, std::size_t end) {
  Rows rows;
  rows.begin.reserve(end - first + 1);
  for (std::size_t c = first; c < end; ++c) {
    for (HalfFaceHandle m : mesh.cell(CellHandle(c)).mate)
      if (m.is_valid()) rows.neighbours.push_back(static_cast<SCOTCH_Num>(cell_of(m).idx()));
    rows.begin.push_back(static_cast<SCOTCH_Num>(rows.neighbours.size()));
  }
  return rows;
}

/// The part of each of this rank's rows; empty where PT-Scotch fails.
std::vector<SCOTCH_Num> parts_of_rows(Comm& comm, Rows& rows) {
  const std::size_t n = rows.begin.size() - 1;
  std::vector<SCOTCH_Num> part(n + 1, 0);
  SCOTCH_Dgraph graph;
  SCOTCH_Strat strategy;
  bool is_good = SCOTCH_dgraphInit(&graph, comm.handle()) == 0;
  if (!is_good) return {};
  SCOTCH_stratInit(&strategy);
  SCOTCH_randomReset();
  const auto n_edges = static_cast<SCOTCH_Num>(rows.neighbours.size());
  rows.neighbours.push_back(0);  // so that there is an address
  is_good = SCOTCH_dgraphBuild(&graph, 0, static_cast<SCOTCH_Num>(n), static_cast<SCOTCH_Num>(n),
                               rows.begin.data(), rows.begin.data() + 1, nullptr, nullptr, n_edges, n_edges,
                               rows.neighbours.data(), nullptr, nullptr) == 0 &&
            SCOTCH_dgraphPart(&graph, static_cast<SCOTCH_Num>(comm.size()), &strategy, part.data()) == 0;
  SCOTCH_stratExit(&strategy);
  SCOTCH_dgraphExit(&graph);
  part.resize(is_good ? n : 0);
  return part;
}

/// The part of each cell, on rank 0; empty where PT-Scotch fails on any rank.
std::vector<SCOTCH_Num> parts_of_cells(Comm& comm, const TetMesh* mesh) {
  std::vector<Packer> to(comm.n_ranks());
  if (mesh)
    for (std::size_t r = 0; r < comm.n_ranks(); ++r) {
      const Rows rows = rows_of(*mesh, par::part_begin(mesh->n_cells(), comm.size(), static_cast<int>(r)),
                                par::part_begin(mesh->n_cells(), comm.size(), static_cast<int>(r) + 1));
      to[r].put_all(rows.begin);
      to[r].put_all(rows.neighbours);
    }
  const auto came = comm.exchange(to);
  Unpacker in(came.at(0).bytes);
  Rows rows;
  rows.begin = in.get_all<SCOTCH_Num>();
  rows.neighbours = in.get_all<SCOTCH_Num>();
  std::vector<SCOTCH_Num> mine = parts_of_rows(comm, rows);
  to.assign(comm.n_ranks(), {});
  to[0].put_all(mine);
  std::vector<SCOTCH_Num> all;
  for (const Comm::Message& message : comm.exchange(to)) {
    const auto part = Unpacker(message.bytes).get_all<SCOTCH_Num>();
    all.insert(all.end(), part.begin(), part.end());
  }
  if (mesh && all.size() != mesh->n_cells()) all.clear();
  return all;
}

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
std::vector<int> by_smallest_cell(const TetMesh& mesh, std::span<const SCOTCH_Num> part, int n_ranks) {
  std::vector<int> owner(mesh.n_vertices(), 0);
  for (std::size_t c = part.size(); c-- > 0;)
    if (!mesh.is_deleted(CellHandle(c)))
      for (VertexHandle v : mesh.cell(CellHandle(c)).v) owner[v.idx()] = static_cast<int>(part[c]);
  std::vector<std::uint8_t> has(static_cast<std::size_t>(n_ranks), 0);
  for (int r : owner) has[static_cast<std::size_t>(r)] = 1;
  if (std::count(has.begin(), has.end(), 1) != n_ranks) owner.clear();
  return owner;
}

}  // namespace

std::vector<int> partition(Comm& comm, const TetMesh* mesh, Partition how) {
  if (how == Partition::kGraph && comm.size() > 1) {
    const std::vector<SCOTCH_Num> part = parts_of_cells(comm, mesh);
    if (!mesh) return {};
    std::vector<int> owner;
    if (!part.empty()) owner = by_smallest_cell(*mesh, part, comm.size());
    return owner.empty() ? by_coordinates(*mesh, comm.size()) : owner;
  }
  if (!mesh) return {};
  return how == Partition::kNumbers ? by_numbers(*mesh, comm.size()) : by_coordinates(*mesh, comm.size());
}

}  // namespace hfr::mpi
