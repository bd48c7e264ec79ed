// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_IMPROVE_HH
#define HFR_DISTRIBUTED_IMPROVE_HH

#include <cstddef>
#include <optional>

#include "hfremesh/Distributed/Comm.hh"
#include "hfremesh/Distributed/Partition.hh"
#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Remesh/Improve.hh"

namespace hfr::mpi {

/// How ranks share the work. The mesh that comes out does not depend on it.
struct Sharing {
  Partition partition = Partition::kCoordinates;
  /// Cells in focus from which on a pass is done by all ranks: cutting the mesh and putting it together takes
  /// about as long as a few passes over all of it.
  std::size_t least_cells = 1'000;
};

/// hfr::improve() with the same bits, some passes done by all ranks of the communicator: those of the polish
/// over edges, faces, vertices and smoothing, over meshes that DistributedMesh::reason_against() has nothing
/// against, with a frozen surface and no invalid cell. All else is done by rank 0, which holds the whole mesh
/// (docs/distributed.md). Called by rank 0 alone, while the others are in serve().
Result improve(TetMesh& mesh, const ImproveOptions& options, Comm& comm, const Sharing& sharing = {});

/// On every other rank: does what improve() asks for, until dismiss(); returns its code.
int serve(Comm& comm);
/// On rank 0: the others return from serve() with this code.
void dismiss(Comm& comm, int code = 0);

}  // namespace hfr::mpi

#endif
