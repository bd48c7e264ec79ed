// SPDX-License-Identifier: BSD-3-Clause
#include "Options.hh"

#include "Numbers.hh"
#include "hfremesh/IO/MeshFile.hh"

namespace hfr::app {

par::Policy CommonOptions::policy() const {
  par::Policy policy = par::Policy::all();
  if (threads > 0) policy.threads = threads;
  return policy;
}

void add_common_options(Command command, CommonOptions& common) {
  command.group("Every subcommand");
  command
      .option("-j,--threads", common.threads,
              "Threads; 0 is every core. The output is the same for each number")
      .type_name("N")
      .shows_default()
      .check(whole_number(0, 1024));
  command.option("--json", common.json, "Write a report in JSON; - is stdout")
      .type_name("FILE")
      .transform(stream_name());
  const Option quiet = command.flag("-q,--quiet", common.quiet, "Print errors only");
  command.flag("-v,--verbose", common.verbose, "Print more").excludes(quiet);
}

void add_format_options(Command command, CommonOptions& common, bool reads, bool writes) {
  command.group("Formats");
  command
      .option("--format", common.format,
              "Format of a mesh on -, the standard stream: an extension such as vtu")
      .type_name("NAME");
  if (reads && writes)
    command.option("--output-format", common.output_format, "The same for the output, where it differs")
        .type_name("NAME");
}

ValueCheck stream_name() {
  const auto rename = [](std::string& path) {
    if (path == io::kStandardInput || path == io::kStandardOutput) path = "-";
    return std::string();
  };
  return rename;
}

void add_split_option(Command command, CommonOptions& common) {
  command.flag("--split-nonmanifold", common.split_nonmanifold,
               "Take the mesh apart where cells meet in a vertex or an edge and no face connects them there");
}

void add_write_options(Command command, io::WriteOptions& options) {
  command.flag("--binary", options.binary, "Binary variant of .msh, .vtk, .stl and .ply");
  command
      .option("--variant", options.variant,
              "Version or encoding: msh 2.2, 4.0, 4.1; vtk 4.2, 5.1; vtu ascii, base64, appended, zlib")
      .type_name("NAME");
}

}  // namespace hfr::app
