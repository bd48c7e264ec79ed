// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_WAIT_PASSIVELY_HH
#define HFR_APPS_WAIT_PASSIVELY_HH

namespace hfr::app {

/// Idle OpenMP threads that spin make short parallel loops many times slower on a busy machine; to sleep and
/// be woken costs a tenth of the time on an idle one. GNU's run-time library may look a thousand times (some
/// 50 microseconds) before it sleeps, which keeps most of both (bench/waiting.py). It reads how to wait
/// before main() starts, so the process has to start once more to change it. Whoever sets one of the
/// variables has decided, and is left alone. First thing in main(), before MPI is initialised.
void wait_passively(char** argv);

}  // namespace hfr::app

#endif
