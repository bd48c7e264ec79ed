// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_COMMANDS_HH
#define HFR_APPS_COMMANDS_HH

#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "ExitCode.hh"
#include "Options.hh"

namespace CLI {
class App;
}

namespace hfr::app {

/// Runs a subcommand whose options are parsed; adds what it did to the report.
using Run = std::function<ExitCode(nlohmann::ordered_json& report)>;

/// Each adds its subcommand to `app`. `common` must outlive what is returned.
Run add_improve(CLI::App& app, CommonOptions& common);
Run add_check(CLI::App& app, CommonOptions& common);
Run add_stats(CLI::App& app, CommonOptions& common);
Run add_convert(CLI::App& app, CommonOptions& common);
Run add_generate(CLI::App& app, CommonOptions& common);
Run add_devices(CLI::App& app, CommonOptions& common);

}  // namespace hfr::app

#endif
