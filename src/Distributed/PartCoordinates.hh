// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_COORDINATES_HH
#define HFR_DISTRIBUTED_PART_COORDINATES_HH

#include "Distributed/DistributedMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr::mpi {

/// What hfr::require_sound_coordinates() throws for the whole mesh, on all ranks at once.
void require_sound_coordinates(DistributedMesh& mesh, par::Policy policy);

}  // namespace hfr::mpi

#endif
