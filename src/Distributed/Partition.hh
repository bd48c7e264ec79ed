// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PARTITION_HH
#define HFR_DISTRIBUTED_PARTITION_HH

#include <vector>

#include "hfremesh/Distributed/Comm.hh"
#include "hfremesh/HalfFace/TetMesh.hh"

namespace hfr::mpi {

/// How a mesh is cut. The mesh that comes out does not depend on it.
enum class Partition {
  kGraph,        ///< PT-Scotch on the cells and their faces: the smallest interfaces
  kCoordinates,  ///< halves by the longest side, again and again: quicker, larger interfaces
  kNumbers       ///< by the numbers of the vertices: for tests, and where the others give nothing
};

/// The rank that owns each vertex, on rank 0; nothing elsewhere. All ranks take part; `mesh` is looked at on
/// rank 0 alone. A vertex is owned by the part of its smallest cell, so each part of the cells becomes a part
/// of the vertices. Where PT-Scotch is missing, fails, or leaves a rank without a cell, by coordinates.
std::vector<int> partition(Comm& comm, const TetMesh* mesh, Partition how);

/// Whether this build has PT-Scotch.
bool has_graph_partition();

}  // namespace hfr::mpi

#endif
