// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_TURNS_HH
#define HFR_DISTRIBUTED_PART_TURNS_HH

#include <cstdint>
#include <vector>

#include "Distributed/DistributedMesh.hh"

namespace hfr::mpi {

/// Turns cells of a mesh as build() does: those that are ordered against most of what they hang together with
/// through faces, then all where most are negative, then each part that hangs together and has more negative
/// cells than positive ones; with Inverted::kLeave none of the last two. `turned`: by cell, whether it was
/// turned already so that the cells of this part agree; empty where none was. Throws InvalidInput, on all
/// ranks, for a mesh that cannot be oriented. All take part.
Turned orient(DistributedMesh& parts, std::vector<std::uint8_t> turned, Inverted inverted);

}  // namespace hfr::mpi

#endif
