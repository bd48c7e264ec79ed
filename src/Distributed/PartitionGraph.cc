// SPDX-License-Identifier: BSD-3-Clause
// C. Chevalier, F. Pellegrini, PT-Scotch: a tool for efficient parallel graph ordering, Parallel Computing
// 34, 2008.
#include "Distributed/PartitionGraph.hh"

#include <cstdio>  // ptscotch.h names FILE

#include <ptscotch.h>

#include "Distributed/Partition.hh"

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

}  // namespace

bool has_graph_partition() { return true; }

std::vector<int> parts_of_cells(Comm& comm, const TetMesh* mesh) {
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
  std::vector<int> all;
  for (const Comm::Message& message : comm.exchange(to)) {
    const auto part = Unpacker(message.bytes).get_all<SCOTCH_Num>();
    all.insert(all.end(), part.begin(), part.end());
  }
  if (mesh && all.size() != mesh->n_cells()) all.clear();
  return all;
}

}  // namespace hfr::mpi
