// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_MPI_PRINT_FIGURES_HH
#define HFR_APPS_MPI_PRINT_FIGURES_HH

#include <span>

#include "hfremesh/Distributed/Improve.hh"

namespace hfr::app {

/// For --traffic, to the error stream: a line for each rank, then one for each phase (docs/distributed.md).
void print_figures(std::span<const mpi::RankFigures> ranks);

}  // namespace hfr::app

#endif
