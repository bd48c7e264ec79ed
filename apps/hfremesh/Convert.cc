// SPDX-License-Identifier: BSD-3-Clause
// hfremesh convert A B: what the file says, in another format; connectivity is not built, so nothing is
// reordered or mended.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "Commands.hh"
#include "Console.hh"
#include "Files.hh"
#include "Json.hh"
#include "Report.hh"

namespace hfr::app {
namespace {

struct ConvertOptions {
  std::string input, output;
  io::WriteOptions write;
};

ExitCode run(const ConvertOptions& options, const CommonOptions& common, Json& report) {
  report["input"]["file"] = options.input;
  report["output"]["file"] = options.output;
  require_writable_mesh(options.output);
  const Stopwatch read;
  const io::MeshData data = read_data(options.input);
  report["seconds"]["read"] = read.seconds();
  std::vector<std::string> notes = data.notes;
  const Stopwatch write;
  for (std::string& note : save(options.output, data, options.write)) notes.push_back(std::move(note));
  report["seconds"]["write"] = write.seconds();
  report["output"].update(contents(data));
  report["notes"] = notes;
  if (!common.quiet) print_notes(notes);
  if (common.prints_table()) print_written(options.output, data);
  return ExitCode::kDone;
}

}  // namespace

Run add_convert(CLI::App& app, CommonOptions& common) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = app.add_subcommand("convert", "Write a mesh in another format");
  command->add_option("A", options->input, "Mesh to read")->required()->type_name("FILE");
  command->add_option("B,-o,--output", options->output, "Mesh to write; its extension gives the format")
      ->required();
  add_write_options(*command, options->write);
  add_common_options(*command, common);
  return [options, &common](Json& report) { return run(*options, common, report); };
}

}  // namespace hfr::app
