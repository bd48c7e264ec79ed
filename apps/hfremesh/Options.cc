// SPDX-License-Identifier: BSD-3-Clause
#include "Options.hh"

#include <CLI/CLI.hpp>

namespace hfr::app {

par::Policy CommonOptions::policy() const {
  par::Policy policy = par::Policy::all();
  if (threads > 0) policy.threads = threads;
  return policy;
}

void add_common_options(CLI::App& command, CommonOptions& common) {
  command.add_option("-j,--threads", common.threads, "Threads; 0, the default, is every core")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
  command.add_option("--json", common.json, "Write a report in JSON; - is stdout")->type_name("FILE");
  CLI::Option* quiet = command.add_flag("-q,--quiet", common.quiet, "Print errors only");
  command.add_flag("-v,--verbose", common.verbose, "Print more")->excludes(quiet);
}

void add_write_options(CLI::App& command, io::WriteOptions& options) {
  command.add_flag("--binary", options.binary, "Binary variant of .msh, .vtk and .vtu");
  command
      .add_option("--variant", options.variant,
                  "Version or encoding: msh 2.2, 4.0, 4.1; vtk 4.2, 5.1; vtu ascii, base64, appended, zlib")
      ->type_name("NAME");
}

}  // namespace hfr::app
