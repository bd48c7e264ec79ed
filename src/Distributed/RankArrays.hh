// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_RANK_ARRAYS_HH
#define HFR_DISTRIBUTED_RANK_ARRAYS_HH

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hfremesh/Distributed/DistributedMesh.hh"

namespace hfr::mpi {

/// What a rank has of a mesh, as a solver has it: cells, each on one rank, and the points that they need.
/// Vertices have numbers in the whole, from 0 without gaps, and so have cells.
struct RankArrays {
  std::vector<std::uint64_t> vertex_number;  ///< by point
  std::vector<Vec3> points;
  std::vector<int> owner;  ///< by point: the rank that owns it
  std::vector<std::uint64_t> cell_number;
  /// Numbers of their vertices: three that are counter-clockwise seen from the fourth, where the volume is
  /// positive, as everywhere in the library.
  std::vector<std::array<std::uint64_t, 4>> cells;
  std::vector<std::int32_t> regions;  ///< by cell, or none where all have 0
  /// Of vertices, edges and faces. Those with smaller numbers stand first in files.
  std::vector<LabelRecord> labels;
};

/// Whether cells stay on the ranks that give them.
enum class Keep : std::uint8_t {
  kAlways,
  kIfEven,  ///< unless a rank gets half as many vertices again as all do on average: then parts are cut anew
};

/// Makes the parts of what the ranks have. A point may come from several ranks, with the same coordinates: of
/// those, the one that gives most of its cells owns it. A cell is given by one rank, which gives its points
/// as well. `owner` is not looked at. A label may come from several ranks; those of one number have the order
/// of ranks, then that of `labels`. Where no rank gives numbers of cells, they are numbered in the order of
/// ranks. All take part. Returns notes, the same on all ranks. Throws InvalidInput for arrays of other
/// lengths, numbers that have gaps or come twice, points that are not finite or differ between ranks, cells
/// and labels whose points are not given, and for what a mesh in parts cannot have (docs/distributed.md).
/// `inverted`: kLeave for a mesh that was oriented before it moved.
std::vector<std::string> from_arrays(DistributedMesh& mesh, const RankArrays& arrays,
                                     Keep keep = Keep::kAlways, Inverted inverted = Inverted::kTurn);

/// The cells that belong to this rank, in the order of their numbers, with their points, and points of this
/// rank that no cell has, in the order of theirs. Labels: what hangs on these points, and on edges and faces
/// of these cells, once each, so that those between ranks come on both. Numbers have no gaps: those of
/// hfr::improve() after TetMesh::collect_garbage(). All take part.
RankArrays own_arrays(DistributedMesh& mesh);

}  // namespace hfr::mpi

#endif
