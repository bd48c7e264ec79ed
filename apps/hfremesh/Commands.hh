// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_COMMANDS_HH
#define HFR_APPS_COMMANDS_HH

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "ExitCode.hh"
#include "Options.hh"
#include "Parser.hh"
#include "Paths.hh"

namespace hfr::app {

/// A subcommand; the two functions count once its options are parsed.
struct Subcommand {
  Command command;
  /// What it reads and writes beside the JSON report.
  std::function<std::vector<FileUse>()> files;
  /// Does it; adds what was done to the report.
  std::function<ExitCode(nlohmann::ordered_json& report)> run;
};

/// Each adds its own to `program`. `common` must outlive what is returned.
Subcommand add_improve(Command program, CommonOptions& common);
Subcommand add_check(Command program, CommonOptions& common);
Subcommand add_stats(Command program, CommonOptions& common);
Subcommand add_convert(Command program, CommonOptions& common);
Subcommand add_generate(Command program, CommonOptions& common);
Subcommand add_move(Command program, CommonOptions& common);
Subcommand add_report(Command program, CommonOptions& common);
Subcommand add_devices(Command program, CommonOptions& common);
Subcommand add_manual(Command program, CommonOptions& common);

}  // namespace hfr::app

#endif
