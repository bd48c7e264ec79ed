// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_WAIT_PASSIVELY_HH
#define HFR_APPS_WAIT_PASSIVELY_HH

namespace hfr::app {

/// Idle OpenMP threads that spin make short parallel loops many times slower on a busy machine. The run-time
/// library reads how to wait before main() starts, so the process has to start once more to change it.
/// Whoever sets one of the variables has decided, and is left alone.
/// First thing in main(), before MPI is initialised.
void wait_passively(char** argv);

}  // namespace hfr::app

#endif
