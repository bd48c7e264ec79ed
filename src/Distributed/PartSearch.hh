// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_SEARCH_HH
#define HFR_DISTRIBUTED_PART_SEARCH_HH

#include <cstdint>

#include "Distributed/DistributedMesh.hh"
#include "Remesh/Ranks.hh"
#include "Scheduler/Seeds.hh"

namespace hfr::mpi {

/// A round of ClusterSearch over a mesh in parts, with the bits that it has in shared memory: see
/// round_on_cutout(). `list`: cells of this part that are to be looked at. `depth`: layers that are tried
/// first, at least 1; the result does not depend on it. All take part.
RoundCounts search_in_parts(DistributedMesh& parts, const Ranks::Search& search, const Worklist& list,
                            std::uint8_t depth = 2);

}  // namespace hfr::mpi

#endif
