// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_INSERTION_HH
#define HFR_DISTRIBUTED_PART_INSERTION_HH

#include <cstdint>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Remesh/Ranks.hh"
#include "Scheduler/Seeds.hh"

namespace hfr::mpi {

/// A round of VertexInsertion over a mesh in parts, with the bits that it has in shared memory: see
/// round_on_cutout(). Rank 0 chooses the cells that get a vertex now.
///
/// `list`: cells of this part that are to be looked at. `waiting`: numbers of cells that share a vertex with
/// a worse one, for the round after, ascending; those of the round before count as listed. `depth`: layers
/// that are tried first, at least 1; the result does not depend on it. All take part.
RoundCounts insert_in_parts(DistributedMesh& parts, const Ranks::Dig& dig, const Worklist& list,
                            std::vector<std::uint64_t>& waiting, std::uint8_t depth = 2);

}  // namespace hfr::mpi

#endif
