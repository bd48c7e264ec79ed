// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_APPS_OPTIONS_HH
#define HFR_APPS_OPTIONS_HH

#include <string>

#include "IO/MeshFile.hh"
#include "Parallel/Parallel.hh"

namespace CLI {
class App;
}

namespace hfr::app {

/// What every subcommand takes.
struct CommonOptions {
  int threads = 0;   ///< 0 = every core
  std::string json;  ///< file for the report, "-" for stdout, empty for none
  bool quiet = false;
  bool verbose = false;

  par::Policy policy() const;
  /// Tables for humans go to stdout unless they are unwanted or the JSON report goes there.
  bool prints_table() const { return !quiet && json != "-"; }
};

void add_common_options(CLI::App& command, CommonOptions& common);
void add_write_options(CLI::App& command, io::WriteOptions& options);

}  // namespace hfr::app

#endif
