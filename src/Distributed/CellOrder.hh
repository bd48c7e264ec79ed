// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_CELL_ORDER_HH
#define HFR_DISTRIBUTED_CELL_ORDER_HH

#include <cstdint>
#include <vector>

#include "Distributed/DistributedMesh.hh"

/// The numbers of cells, as the functions of HalfFace/Reorder.hh give them in shared memory.
namespace hfr::mpi {

/// No slot of a cell is free in the whole or on any rank, and no vertex deleted. All take part.
bool is_dense(DistributedMesh& mesh);
/// Of a dense mesh: as hfr::is_scattered(). All take part.
bool is_scattered(DistributedMesh& mesh);
/// For each slot of a dense mesh the number that hfr::reorder() of cells alone along
/// Morton's curve gives it. All take part.
std::vector<std::uint64_t> numbers_along_curve(DistributedMesh& mesh);

}  // namespace hfr::mpi

#endif
