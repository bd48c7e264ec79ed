// SPDX-License-Identifier: BSD-3-Clause
#include "Options.hh"

#include <CLI/CLI.hpp>

#include "Numbers.hh"
#include "hfremesh/IO/MeshFile.hh"

namespace hfr::app {

par::Policy CommonOptions::policy() const {
  par::Policy policy = par::Policy::all();
  if (threads > 0) policy.threads = threads;
  return policy;
}

void add_common_options(CLI::App& command, CommonOptions& common) {
  command.add_option("-j,--threads", common.threads, "Threads; 0, the default, is every core")
      ->type_name("N")
      ->check(whole_number(0, 1024));
  command.add_option("--json", common.json, "Write a report in JSON; - is stdout")
      ->type_name("FILE")
      ->transform(stream_name());
  CLI::Option* quiet = command.add_flag("-q,--quiet", common.quiet, "Print errors only");
  command.add_flag("-v,--verbose", common.verbose, "Print more")->excludes(quiet);
}

void add_format_options(CLI::App& command, CommonOptions& common, bool reads, bool writes) {
  command
      .add_option("--format", common.format,
                  "Format of a mesh on -, the standard stream: an extension such as vtu")
      ->type_name("NAME");
  if (reads && writes)
    command.add_option("--output-format", common.output_format, "The same for the output, where it differs")
        ->type_name("NAME");
}

CLI::Validator stream_name() {
  const auto rename = [](std::string& path) {
    if (path == io::kStandardInput || path == io::kStandardOutput) path = "-";
    return std::string();
  };
  return {rename, ""};
}

void add_split_option(CLI::App& command, CommonOptions& common) {
  command.add_flag(
      "--split-nonmanifold", common.split_nonmanifold,
      "Take the mesh apart where cells meet in a vertex or an edge and no face connects them there");
}

void add_write_options(CLI::App& command, io::WriteOptions& options) {
  command.add_flag("--binary", options.binary, "Binary variant of .msh, .vtk and .vtu");
  command
      .add_option("--variant", options.variant,
                  "Version or encoding: msh 2.2, 4.0, 4.1; vtk 4.2, 5.1; vtu ascii, base64, appended, zlib")
      ->type_name("NAME");
}

}  // namespace hfr::app
