// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_MEMORY_HH
#define HFR_APPS_MEMORY_HH

#include <string>

namespace hfr::app {

/// Bytes that the process may still take without the machine, its container or a limit of its own ending it;
/// infinity where nothing is known.
double available_memory();

/// Fails with exit code 5 when `what` needs more than that.
void require_memory(double bytes, const std::string& what);

}  // namespace hfr::app

#endif
