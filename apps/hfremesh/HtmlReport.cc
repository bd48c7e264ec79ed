// SPDX-License-Identifier: BSD-3-Clause
// hfremesh report BEFORE AFTER -o PAGE: a page, a picture, or both, about two files.
#include <fmt/format.h>

#include <memory>

#include "Commands.hh"
#include "Console.hh"
#include "Files.hh"
#include "Json.hh"
#include "Presentation.hh"
#include "Report.hh"

namespace hfr::app {
namespace {

struct ReportLine {
  std::string before, after;
  PresentationFiles files;
};

ExitCode run(const ReportLine& line, const CommonOptions& common, Json& report) {
  if (!line.files.any())
    throw Failure(ExitCode::kUsage, "-o FILE or --png FILE is required; try 'hfremesh report --help'");
  require_presentable(line.files);
  Presentation presentation(line.files, line.before, line.after, common.policy());
  std::vector<std::string> notes;
  std::array<Statistics, 2> figures;
  double seconds_read = 0, seconds_build = 0, seconds_statistics = 0;
  const std::array<const std::string*, 2> files = {&line.before, &line.after};
  const std::array<const char*, 2> sides = {"before", "after"};
  for (std::size_t i = 0; i < files.size(); ++i) {
    LoadedMesh loaded = load(*files[i], common);
    seconds_read += loaded.seconds_read;
    seconds_build += loaded.seconds_build;
    notes.insert(notes.end(), loaded.notes.begin(), loaded.notes.end());
    const Stopwatch watch;
    figures[i] = statistics(loaded.mesh, common.policy());
    seconds_statistics += watch.seconds();
    report["files"][sides[i]] = *files[i];
    report[sides[i]] = to_json(figures[i]);
    if (i == 0)
      presentation.add_before(loaded.mesh);
    else
      presentation.add_after(loaded.mesh, nullptr);
  }
  report["seconds"] = {{"read", seconds_read}, {"build", seconds_build}, {"statistics", seconds_statistics}};
  report["notes"] = notes;
  if (!common.quiet) print_notes(notes);
  if (common.prints_table()) print_statistics({{"before", &figures[0]}, {"after", &figures[1]}});
  return presentation.save(figures[0], figures[1], report, ExitCode::kDone);
}

}  // namespace

Subcommand add_report(Command program, CommonOptions& common) {
  const auto line = std::make_shared<ReportLine>();
  Command command = program.subcommand("report", "Make a page or a picture of a mesh before and after");
  command.example("hfremesh report bad.mesh good.mesh -o both.html", "a page with views of both");
  command.example("hfremesh report bad.mesh good.mesh --png both.png", "a picture");
  command.group("Mesh");
  command.option("BEFORE", line->before, "Mesh before").required().type_name("FILE").transform(stream_name());
  command.option("AFTER", line->after, "Mesh after").required().type_name("FILE").transform(stream_name());
  command.group("Output");
  add_presentation_options(command, line->files, "-o,--output");
  add_format_options(command, common, true, false);
  add_common_options(command, common);
  using Kind = FileUse::Kind;
  return {command,
          [line] {
            return std::vector<FileUse>{{Kind::kInput, "BEFORE", line->before},
                                        {Kind::kInput, "AFTER", line->after},
                                        {Kind::kReport, "-o", line->files.page},
                                        {Kind::kReport, "--png", line->files.png}};
          },
          [line, &common](Json& report) { return run(*line, common, report); }};
}

}  // namespace hfr::app
