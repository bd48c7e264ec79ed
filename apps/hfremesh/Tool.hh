// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_TOOL_HH
#define HFR_APPS_TOOL_HH

#include <functional>
#include <string>

#include "ExitCode.hh"
#include "Options.hh"

namespace hfr::app {

/// What another program of the same tool has of its own.
struct Variant {
  std::string name = "hfremesh";
  int threads = 0;          ///< where the command line names none; 0 = every core
  ImproveFunction improve;  ///< does a run of `improve`; the library's where it is empty
  /// Adds options to `improve`, whose help is then that of the program.
  std::function<void(Command& improve)> add_options;
};

/// The whole tool, from the command line to the exit code.
ExitCode run_tool(int argc, char** argv, const Variant& variant = {});

}  // namespace hfr::app

#endif
