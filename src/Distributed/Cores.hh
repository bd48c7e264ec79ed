// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_CORES_HH
#define HFR_DISTRIBUTED_CORES_HH

#include "hfremesh/Distributed/Comm.hh"

namespace hfr::mpi {

/// Rank 0 works while the others sleep: it may then use the cores that they are bound to. Lets rank 0 run on
/// the cores of all ranks of its machine, and returns there how many threads are worth while: one a rank, as
/// far as there are cores; 1 on other ranks. Called by all ranks, before the first parallel loop. Where the
/// system has no such binding, only the number is found.
int lend_cores(const Comm& comm);

}  // namespace hfr::mpi

#endif
