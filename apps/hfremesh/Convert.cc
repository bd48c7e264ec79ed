// SPDX-License-Identifier: BSD-3-Clause
// hfremesh convert A B: what the file says, in another format; connectivity is not built, so nothing is
// reordered or mended, unless it is to be split where it is not manifold.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "Commands.hh"
#include "Console.hh"
#include "Files.hh"
#include "Json.hh"
#include "WriteMesh.hh"
#include "hfremesh/IO/Assemble.hh"

namespace hfr::app {
namespace {

struct ConvertOptions {
  std::string input, output;
  io::WriteOptions write;
};

ExitCode run(const ConvertOptions& options, const CommonOptions& common, Json& report) {
  report["input"]["file"] = options.input;
  report["output"]["file"] = options.output;
  const io::WriteOptions write_options = require_writable_mesh(options.output, options.write, common);
  const Stopwatch read;
  io::MeshData data = read_data(options.input, common);
  report["seconds"]["read"] = read.seconds();
  std::vector<std::string> notes = data.notes;
  if (common.split_nonmanifold && !data.cells.empty()) {
    const LoadedMesh loaded = load(std::move(data), options.input, common);
    report["input"].update(to_json(loaded.report));
    notes = loaded.notes;
    data = io::disassemble(loaded.mesh, common.policy());
  }
  return write_mesh(options.output, data, write_options, std::move(notes), common, report);
}

}  // namespace

Subcommand add_convert(Command program, CommonOptions& common) {
  const auto options = std::make_shared<ConvertOptions>();
  Command command = program.subcommand("convert", "Write a mesh in another format");
  command.example("hfremesh convert in.mesh out.vtu --variant zlib", "for ParaView, compressed");
  command.example("hfremesh convert in.mesh - --output-format vtk > out.vtk", "to the standard output");
  command.group("Mesh");
  command.option("A", options->input, "Mesh to read").required().type_name("FILE").transform(stream_name());
  command.option("B,-o,--output", options->output, "Mesh to write; its extension gives the format")
      .required()
      .type_name("FILE")
      .transform(stream_name());
  add_format_options(command, common, true, true);
  add_split_option(command, common);
  add_write_options(command, options->write);
  add_common_options(command, common);
  using Kind = FileUse::Kind;
  return {
      command,
      [options] {
        return std::vector<FileUse>{{Kind::kInput, "A", options->input}, {Kind::kMesh, "B", options->output}};
      },
      [options, &common](Json& report) { return run(*options, common, report); }};
}

}  // namespace hfr::app
