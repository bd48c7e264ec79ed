// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_THREADS_HH
#define HFR_APPS_THREADS_HH

namespace hfr::app {

/// Of so many threads, those to work with: all if the system lets them be made, else half of what it lets, so
/// that there is room for memory and for a device's own. OpenMP would end the process on the first thread
/// that it cannot have.
int usable_threads(int wanted);

}  // namespace hfr::app

#endif
