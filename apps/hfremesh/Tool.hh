// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_TOOL_HH
#define HFR_APPS_TOOL_HH

#include "ExitCode.hh"
#include "Options.hh"

namespace hfr::app {

/// The whole tool, from the command line to the exit code. `improve`: what does a run of `improve`; the
/// library's where it is empty.
ExitCode run_tool(int argc, char** argv, ImproveFunction improve = {});

}  // namespace hfr::app

#endif
