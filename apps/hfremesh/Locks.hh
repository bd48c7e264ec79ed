// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_LOCKS_HH
#define HFR_APPS_LOCKS_HH

#include <string>
#include <vector>

#include "hfremesh/Surface/SurfaceOptions.hh"

namespace hfr::app {

/// What --fix and --periodic name, each as it was given. Throws Failure with ExitCode::kUsage.
void add_locks(SurfaceOptions& surface, const std::vector<std::string>& fix,
               const std::vector<std::string>& periodic);

}  // namespace hfr::app

#endif
