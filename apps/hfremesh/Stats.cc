// SPDX-License-Identifier: BSD-3-Clause
// hfremesh stats A [B]: figures of one mesh, or of two side by side.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "Commands.hh"
#include "Console.hh"
#include "Files.hh"
#include "Json.hh"
#include "Report.hh"
#include "hfremesh/IO/Hash.hh"

namespace hfr::app {
namespace {

constexpr std::size_t kBarWidth = 50;

void print_histogram(const std::string& name, const Statistics& statistics) {
  print("\ndihedral angles of {}\n", name);
  const auto& bins = statistics.dihedral_histogram;
  const std::uint64_t tallest = std::max<std::uint64_t>(1, *std::max_element(bins.begin(), bins.end()));
  for (std::size_t i = 0; i < bins.size(); ++i)
    print("{:>3} - {:>3}  {:>12}  {:#<{}}\n", 5 * i, 5 * i + 5, grouped(bins[i]), "",
          static_cast<std::size_t>(bins[i] * kBarWidth / tallest));
}

ExitCode run(const std::vector<std::string>& files, const CommonOptions& common, Json& report) {
  std::vector<Statistics> all;
  std::vector<std::string> notes;
  double seconds_read = 0, seconds_build = 0, seconds_statistics = 0;
  report["meshes"] = Json::array();
  for (const std::string& file : files) {
    LoadedMesh loaded = load(file, common);
    seconds_read += loaded.seconds_read;
    seconds_build += loaded.seconds_build;
    notes.insert(notes.end(), loaded.notes.begin(), loaded.notes.end());
    const Stopwatch watch;
    all.push_back(statistics(loaded.mesh, common.policy()));
    seconds_statistics += watch.seconds();
    if (common.json.empty()) continue;
    Json entry;
    entry["file"] = file;
    entry.update(to_json(loaded.report));
    entry["hash"] = io::hash_text(io::mesh_hash(loaded.mesh));
    entry["statistics"] = to_json(all.back());
    report["meshes"].push_back(std::move(entry));
  }
  report["seconds"] = {{"read", seconds_read}, {"build", seconds_build}, {"statistics", seconds_statistics}};
  report["notes"] = notes;
  if (!common.quiet) print_notes(notes);
  if (!common.prints_table()) return ExitCode::kDone;
  std::vector<Column> columns;
  for (std::size_t i = 0; i < all.size(); ++i)
    columns.push_back({std::filesystem::path(files[i]).filename().string(), &all[i]});
  print_statistics(columns);
  if (common.verbose)
    for (const Column& column : columns) print_histogram(column.heading, *column.statistics);
  return ExitCode::kDone;
}

}  // namespace

Subcommand add_stats(Command program, CommonOptions& common) {
  const auto files = std::make_shared<std::vector<std::string>>();
  Command command = program.subcommand("stats", "Print the figures of one mesh, or of two side by side");
  command.example("hfremesh stats bad.mesh good.mesh", "figures side by side");
  command.example("hfremesh stats bad.mesh -v", "with histograms");
  command.group("Mesh");
  command.option("A B", *files, "Meshes to read")
      .required()
      .expected(1, 2)
      .type_name("A [B]")
      .transform(stream_name());
  add_format_options(command, common, true, false);
  add_common_options(command, common);
  return {command,
          [files] {
            std::vector<FileUse> uses;
            for (const std::string& file : *files)
              uses.push_back({FileUse::Kind::kInput, uses.empty() ? "A" : "B", file});
            return uses;
          },
          [files, &common](Json& report) { return run(*files, common, report); }};
}

}  // namespace hfr::app
