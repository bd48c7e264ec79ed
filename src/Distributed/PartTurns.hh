// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_TURNS_HH
#define HFR_DISTRIBUTED_PART_TURNS_HH

#include "Distributed/DistributedMesh.hh"

namespace hfr::mpi {

/// Turns cells of a mesh as build() does: all of them where most are negative, then each part that hangs
/// together through faces and has more negative cells than positive ones. All take part.
Turned turn_negative_components(DistributedMesh& parts);

}  // namespace hfr::mpi

#endif
