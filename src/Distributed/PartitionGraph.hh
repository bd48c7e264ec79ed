// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PARTITION_GRAPH_HH
#define HFR_DISTRIBUTED_PARTITION_GRAPH_HH

#include <vector>

#include "hfremesh/Distributed/Comm.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::mpi {

/// The rank of each cell by PT-Scotch, on rank 0; empty elsewhere, where PT-Scotch fails on any rank, and in
/// builds without. All ranks take part; `mesh` is looked at on rank 0 alone.
std::vector<int> parts_of_cells(Comm& comm, const TetMesh* mesh);

}  // namespace hfr::mpi

#endif
