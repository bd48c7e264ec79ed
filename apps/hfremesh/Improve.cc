// SPDX-License-Identifier: BSD-3-Clause
// hfremesh improve IN -o OUT: what the tool does when no subcommand is named.
#include "hfremesh/Remesh/Improve.hh"
#include "hfremesh/Surface/FeatureLabels.hh"

#include <fmt/format.h>

#include <memory>

#include "Commands.hh"
#include "Console.hh"
#include "Fields.hh"
#include "Files.hh"
#include "ImproveLine.hh"
#include "ImproveReport.hh"
#include "ImproveSurface.hh"
#include "Json.hh"
#include "Labels.hh"
#include "Presentation.hh"
#include "Report.hh"
#include "Signals.hh"
#include "hfremesh/IO/Assemble.hh"

namespace hfr::app {
namespace {

Result improve_with_progress(TetMesh& mesh, ImproveOptions options, const ImproveLine& line,
                             const CommonOptions& common, const SignalGuard& signals,
                             Presentation& presentation) {
  using Style = ProgressView::Style;
  const bool bar = !common.quiet && stderr_is_terminal();
  const Style style = line.progress ? Style::kLines : bar ? Style::kBar : Style::kNone;
  ProgressView view(style);
  // Each call costs improve() a look at every cell, so it is asked for only where it is seen.
  if (style != Style::kNone || presentation.watches())
    options.progress = [&](const Progress& progress) {
      view.show(progress);
      presentation.note(progress);
    };
  options.cancel = [&signals] { return signals.cancelled(); };
  return common.improve(mesh, options);
}

/// Everything that stands in the way of a run, and what the user should know of the input.
LoadedMesh load_for_run(io::MeshData data, const ImproveLine& line, const ImproveOptions& options,
                        const CommonOptions& common) {
  if (line.min_angle > 0)
    throw Failure(ExitCode::kUsage, "--min-angle is for surfaces; use --min-dihedral for tetrahedra");
  std::vector<std::string> notes;
  const bool frozen = options.surface.mode == SurfaceMode::kFrozen;
  if (line.ignore_labels && !frozen) notes = drop_labels(data);
  LoadedMesh loaded = load(std::move(data), line.input, common);
  if (line.ignore_labels && frozen) notes = drop_inner_labels(loaded.mesh);
  const auto add = [&](std::vector<std::string> more) {
    loaded.notes.insert(loaded.notes.end(), more.begin(), more.end());
  };
  add(std::move(notes));
  add(notes_on_inner_triangles(loaded.mesh));
  add(notes_on_idle_options(line, true));
  require_fixed(options.surface, loaded.mesh);
  return loaded;
}

/// A file of triangles only.
ExitCode run_on_surface(io::MeshData data, const ImproveLine& line, const ImproveOptions& options,
                        const io::WriteOptions& write_options, double seconds_read,
                        const CommonOptions& common, Json& report) {
  const auto add = [&](std::vector<std::string> more) {
    data.notes.insert(data.notes.end(), more.begin(), more.end());
  };
  if (line.ignore_labels) add(drop_labels(data));
  add(notes_on_idle_options(line, false));
  return improve_surface({line.input, line.output, line.dry_run, line.surface.mode, line.min_dihedral,
                          line.min_angle, line.time_limit, options.surface, write_options, seconds_read},
                         std::move(data), common, report);
}

/// What a run would do, in place of the run.
ExitCode print_plan(const LoadedMesh& loaded, const ImproveOptions& options, const CommonOptions& common,
                    Json& report) {
  const std::string text = plan(loaded.mesh, options);
  report["plan"] = text;
  report["notes"] = loaded.notes;
  if (!common.quiet) print_notes(loaded.notes);
  if (common.prints_table()) print("{}", text);
  return ExitCode::kDone;
}

/// Improves the mesh of `data` and writes it; `seconds` has the time of reading.
ExitCode run_on_mesh(io::MeshData data, const ImproveLine& line, const ImproveOptions& options,
                     const io::WriteOptions& write_options, Seconds seconds, const CommonOptions& common,
                     Json& report) {
  const PointsOfFields points_before(data);
  LoadedMesh loaded = load_for_run(std::move(data), line, options, common);
  seconds.build = loaded.seconds_build;
  report["input"].update(to_json(loaded.report));
  if (line.plan) return print_plan(loaded, options, common, report);

  Presentation presentation(line.presentation, line.input, line.output, common.policy());
  presentation.add_before(loaded.mesh);
  const SignalGuard signals;  // from here on there is something to save
  const Stopwatch improving;
  const Result result = improve_with_progress(loaded.mesh, options, line, common, signals, presentation);
  seconds.improve = result.seconds;
  if (line.label_features) label_features(loaded.mesh, options.surface, options.policy);
  seconds.statistics = improving.seconds() - result.seconds;

#ifndef NDEBUG  // improve() has tested what it changed; a second look takes three times as long as a short
                // run
  if (result.changed && !line.dry_run) require_sound(loaded.mesh, line.input, common);
#endif
  const Stopwatch writing;
  data = io::disassemble(loaded.mesh, common.policy());
  std::vector<std::string> notes = std::move(loaded.notes);
  const auto add = [&](std::vector<std::string> more) {
    notes.insert(notes.end(), more.begin(), more.end());
  };
  add(points_before.notes(data));
  if (!line.quality_array.empty()) add_quality_array(line.quality_array, common.policy(), data);
  if (!line.dry_run) {
    add(notes_on_replacing(line.output));
    add(save(line.output, data, write_options));
  }
  seconds.write = writing.seconds();
  if (!result.device_note.empty()) notes.push_back("no device, or not to the end: " + result.device_note);

  // The mesh is saved: whatever goes wrong from here on loses a report and no more.
  ExitCode code = exit_code_of(result);
  try {
    report["output"].update(contents(data));
    report_run(report, loaded.mesh, result, options, seconds);
    report["notes"] = notes;
    if (!common.quiet) print_notes(notes);
    if (common.prints_table()) print_result(result, seconds, line.dry_run, common);
    if (code != ExitCode::kDone) print_error(line.input + ": " + shortfall(result, options));
    presentation.add_after(loaded.mesh, &result);
    code = presentation.save(result.before, result.after, report, code);
  } catch (const std::exception& error) {
    code = without_report(error, code);
  }
  return line.ids.empty() ? code
                          : save_report(
                                line.ids, [&] { return ids_text(loaded.mesh, result); }, code);
}

ExitCode run(const ImproveLine& line, const CommonOptions& common, Json& report) {
  const bool writes = !line.dry_run && !line.plan;
  if (line.plan && !line.ids.empty())
    throw Failure(ExitCode::kUsage, "--plan runs nothing, so there are no cells for --ids");
  if (line.output.empty() && writes)
    throw Failure(ExitCode::kUsage, "-o FILE is required (or --dry-run); try 'hfremesh improve --help'");
  const ImproveOptions options = improve_options(line, common);
  report["input"]["file"] = line.input;
  report["options"] = options_json(line, options);
  io::WriteOptions write_options;
  if (writes) {
    report["output"]["file"] = line.output;
    write_options = require_writable_mesh(line.output, line.write, common);
  }
  require_quality_array(line.quality_array, writes ? line.output : "", write_options);
  if (line.plan && line.presentation.any())
    throw Failure(ExitCode::kUsage, "--plan runs nothing, so there is nothing for --png and --report");
  if (!line.ids.empty()) require_writable(line.ids);
  require_presentable(line.presentation);
  const Stopwatch reading;
  io::MeshData data = read_data(line.input, common);
  const double seconds_read = reading.seconds();
  const bool is_surface = data.cells.empty() && !data.triangles.empty();
  if (is_surface && (!line.quality_array.empty() || !line.ids.empty() || line.presentation.any()))
    throw Failure(ExitCode::kUsage, "--quality-array, --ids, --png and --report are for tetrahedra, and " +
                                        line.input + " has none");
  if (is_surface && line.plan)
    throw Failure(ExitCode::kUsage, "--plan is for tetrahedra, and " + line.input + " has none");
  if (is_surface)
    return run_on_surface(std::move(data), line, options, write_options, seconds_read, common, report);
  return run_on_mesh(std::move(data), line, options, write_options, {.read = seconds_read}, common, report);
}

}  // namespace

Subcommand add_improve(Command program, CommonOptions& common) {
  const auto line = std::make_shared<ImproveLine>();
  Command command = program.subcommand("improve", "Repair and improve a mesh (the default)");
  add_improve_options(command, *line, common);
  using Kind = FileUse::Kind;
  return {command,
          [line] {
            return std::vector<FileUse>{{Kind::kInput, "IN", line->input},
                                        {Kind::kMesh, "-o", line->dry_run ? "" : line->output, !line->plan},
                                        {Kind::kReport, "--ids", line->ids},
                                        {Kind::kReport, "--png", line->presentation.png},
                                        {Kind::kReport, "--report", line->presentation.page}};
          },
          [line, &common](Json& report) { return run(*line, common, report); }};
}

}  // namespace hfr::app
