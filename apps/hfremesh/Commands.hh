// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_COMMANDS_HH
#define HFR_APPS_COMMANDS_HH

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "ExitCode.hh"
#include "Options.hh"
#include "Paths.hh"

namespace CLI {
class App;
}

namespace hfr::app {

/// A subcommand whose options are parsed.
struct Run {
  /// What it reads and writes beside the JSON report.
  std::function<std::vector<FileUse>()> files;
  /// Does it; adds what was done to the report.
  std::function<ExitCode(nlohmann::ordered_json& report)> run;
};

/// Each adds its subcommand to `app`. `common` must outlive what is returned.
Run add_improve(CLI::App& app, CommonOptions& common);
Run add_check(CLI::App& app, CommonOptions& common);
Run add_stats(CLI::App& app, CommonOptions& common);
Run add_convert(CLI::App& app, CommonOptions& common);
Run add_generate(CLI::App& app, CommonOptions& common);
Run add_devices(CLI::App& app, CommonOptions& common);

}  // namespace hfr::app

#endif
