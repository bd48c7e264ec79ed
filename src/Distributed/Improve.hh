// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_IMPROVE_HH
#define HFR_DISTRIBUTED_IMPROVE_HH

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "hfremesh/Distributed/Comm.hh"
#include "hfremesh/Distributed/Partition.hh"
#include "hfremesh/Distributed/RankFigures.hh"
#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Remesh/Improve.hh"

namespace hfr::mpi {

/// How ranks share the work. The mesh that comes out does not depend on it.
struct Sharing {
  Partition partition = Partition::kCoordinates;
  /// Threads of each rank in what all ranks do; 0: as many as the options of the run say, which are those of
  /// rank 0 while the others wait.
  int threads = 0;
  /// Cells in focus from which on a pass is done by all ranks; also one of so many cells of the mesh. To hand
  /// the mesh out and to put it together takes as long as about that many cells take to be mended on one
  /// thread (docs/distributed.md). Counts decide and no clock, so the same passes are shared each time.
  std::size_t least_cells = 1'000;
  std::size_t least_one_in = 32;
  /// Where it is set: told on rank 0, at the end of improve(), of each rank.
  std::function<void(std::span<const RankFigures>)> tell_figures = {};
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
