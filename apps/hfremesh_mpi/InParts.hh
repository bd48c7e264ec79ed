// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_MPI_IN_PARTS_HH
#define HFR_APPS_MPI_IN_PARTS_HH

#include "hfremesh/Distributed/Comm.hh"

namespace hfr::app {

/// Whether the command line is one of hfremesh-mpi parts, which no rank does by itself.
bool is_in_parts(int argc, char** argv);
/// All of it, on all ranks at the same time; returns the exit code. Rank 0 prints.
int run_in_parts(int argc, char** argv, mpi::Comm& comm);

}  // namespace hfr::app

#endif
