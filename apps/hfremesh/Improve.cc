// SPDX-License-Identifier: BSD-3-Clause
// hfremesh improve IN -o OUT: what the tool does when no subcommand is named.
#include "hfremesh/Remesh/Improve.hh"
#include "hfremesh/Surface/FeatureLabels.hh"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "Commands.hh"
#include "Console.hh"
#include "Fields.hh"
#include "Files.hh"
#include "ImproveSurface.hh"
#include "Json.hh"
#include "Labels.hh"
#include "Numbers.hh"
#include "Report.hh"
#include "Signals.hh"
#include "hfremesh/IO/Assemble.hh"

namespace hfr::app {
namespace {

constexpr double kLargestDihedral = 70.5;  // degrees; the regular tetrahedron has 70.53

/// The command line as it was given; names are looked up before the input is read.
struct CommandLine {
  std::string input, output;
  bool dry_run = false;
  bool plan = false;
  bool progress = false;
  bool label_features = false;
  bool ignore_labels = false;
  std::string ops, metric, smoother, rounds, compat;
  std::string surface;
  std::vector<std::string> fix, periodic;
  double hausdorff = -1;  ///< negative = not given
  std::optional<double> feature_angle;
  std::string device;  ///< as device_choice_from_name() has it
  bool no_insert = false;
  std::string min_dihedral;  ///< degrees or "max"
  double min_angle = 0;      ///< degrees, for surfaces; 0 = none
  std::string ids;           ///< file for the cells that are stuck, empty for none
  double time_limit = 0;     ///< 0 = none
  io::WriteOptions write;
  ImproveOptions improve;
};

/// What follows `prefix`, split at `separator` into `n` numbers; an empty list when the text is something
/// else.
template <class Integer>
std::vector<Integer> numbers_after(const std::string& text, const std::string& prefix, char separator,
                                   std::size_t n) {
  if (!text.starts_with(prefix)) return {};
  std::vector<Integer> numbers;
  for (std::size_t at = prefix.size(); at < text.size();) {
    const std::size_t end = std::min(text.find(separator, at), text.size());
    const auto number = integer_of<Integer>(std::string_view(text).substr(at, end - at));
    if (!number) return {};
    numbers.push_back(*number);
    at = end + 1;
  }
  if (numbers.size() != n) numbers.clear();
  return numbers;
}

/// N vertices after `prefix`; nothing when the text is something else.
template <std::size_t N>
std::optional<std::array<VertexHandle, N>> vertices_after(const std::string& text,
                                                          const std::string& prefix) {
  const auto numbers = numbers_after<std::uint64_t>(text, prefix, '-', N);
  if (numbers.empty()) return std::nullopt;
  std::array<VertexHandle, N> vertices;
  for (std::size_t i = 0; i < N; ++i) {
    if (numbers[i] >= VertexHandle::kInvalid) return std::nullopt;
    vertices[i] = VertexHandle(static_cast<Index>(numbers[i]));
  }
  return vertices;
}

/// --fix and --periodic.
void add_locks(SurfaceOptions& surface, const std::vector<std::string>& fix,
               const std::vector<std::string>& periodic) {
  for (const std::string& what : fix) {
    if (const auto p = numbers_after<int>(what, "patch:", '\0', 1); !p.empty()) {
      surface.fixed_patches.push_back(p[0]);
    } else if (const auto v = vertices_after<1>(what, "vertex:")) {
      surface.fixed_vertices.push_back((*v)[0]);
    } else if (const auto e = vertices_after<2>(what, "edge:")) {
      surface.fixed_edges.push_back(*e);
    } else if (const auto f = vertices_after<3>(what, "face:")) {
      surface.fixed_faces.push_back(*f);
    } else {
      throw Failure(ExitCode::kUsage,
                    "--fix takes patch:N, vertex:N, edge:N-N and face:N-N-N, not " + in_quotes(what));
    }
  }
  for (const std::string& pair : periodic) {
    const auto patches = numbers_after<int>(pair, "", ':', 2);
    if (patches.empty())
      throw Failure(ExitCode::kUsage, "--periodic takes A:B, two patches, not " + in_quotes(pair));
    surface.periodic.push_back({patches[0], patches[1]});
  }
}

ImproveOptions improve_options(const CommandLine& line, const CommonOptions& common) {
  ImproveOptions options = line.improve;
  if (!line.ops.empty()) options.ops = ops_from_list(line.ops);
  if (line.min_dihedral == "max")
    options.raise_min_dihedral = true;
  else if (!line.min_dihedral.empty())
    options.min_dihedral = real_of(line.min_dihedral);
  if (line.no_insert) options.ops = without(options.ops, Ops::kInsert);
  if (!line.metric.empty()) options.metric = metric_from_name(line.metric);
  if (!line.smoother.empty()) options.smoother = smoother_from_name(line.smoother);
  if (!line.rounds.empty()) options.rounds = rounds_from_name(line.rounds);
  if (!line.compat.empty()) options.compat = Compat::kJpdc2013;
  if (!line.device.empty()) options.device = device_choice_from_name(line.device);
  if (line.time_limit > 0) options.time_limit = line.time_limit;
  if (line.surface == "flat") options.surface.mode = SurfaceMode::kFlat;
  if (line.surface == "free") options.surface.mode = SurfaceMode::kFree;
  if (line.hausdorff >= 0) options.surface.hausdorff = line.hausdorff;
  if (line.feature_angle) options.surface.feature_angle = *line.feature_angle;
  add_locks(options.surface, line.fix, line.periodic);
  options.policy = common.policy();
  options.statistics = common.prints_table() || !common.json.empty() || !line.ids.empty();
  return options;
}

Json options_json(const CommandLine& line, const ImproveOptions& options) {
  Json json;
  json["min_dihedral"] = options.min_dihedral ? Json(*options.min_dihedral) : Json();
  if (options.raise_min_dihedral) json["min_dihedral"] = "max";
  json["iterations"] = options.iterations;
  json["time_limit"] = line.time_limit > 0 ? Json(line.time_limit) : Json();
  json["ops"] = ops_to_list(options.ops);
  json["metric"] = metric_name(options.metric);
  json["min_cells"] = options.min_cells > 0 ? Json(options.min_cells) : Json();
  json["coarsen"] = options.coarsen;
  json["max_cells"] = options.max_cells > 0 ? Json(options.max_cells) : Json();
  json["smoother"] = line.smoother.empty() ? Json() : Json(line.smoother);
  json["rounds"] = line.rounds.empty() ? Json() : Json(line.rounds);
  json["compat"] = line.compat.empty() ? Json() : Json(line.compat);
  json["surface"] = line.surface.empty() ? "frozen" : line.surface;
  json["device"] = line.device.empty() ? "cpu" : line.device;
  json["hybrid"] = options.hybrid;
  json["bulk_nodes"] = options.bulk_nodes;
  json["seed"] = options.seed;
  json["ignore_labels"] = line.ignore_labels;
  json["dry_run"] = line.dry_run;
  return json;
}

ExitCode exit_code_of(const Result& result) {
  if (result.stop == Stop::kCancelled) return ExitCode::kCancelled;
  if (result.stop == Stop::kDeviceLost) return ExitCode::kDevice;
  if (result.goal_reached) return ExitCode::kDone;
  if (result.stop == Stop::kTimeLimit) return ExitCode::kLimit;
  return result.invalid_cells.empty() ? ExitCode::kGoalMissed : ExitCode::kInvalidCells;
}

/// With a length of two digits that is no smaller.
std::string round_up_option(std::string_view name, double length) {
  const double unit = std::pow(10.0, std::floor(std::log10(length)) - 1);
  return fmt::format("{} {:.2g}", name, std::ceil(length / unit) * unit);
}

/// One line that says why the exit code is not 0.
std::string shortfall(const Result& result, const ImproveOptions& options) {
  std::string text;
  if (result.stop == Stop::kCancelled) text = "cancelled; the mesh is the best so far";
  if (result.stop == Stop::kDeviceLost)
    text = fmt::format("the device failed, and the mesh is that of the last finished round: {}",
                       result.device_note);
  if (result.stop == Stop::kTimeLimit && !result.goal_reached)
    text = "the time limit was met; the mesh is the best so far";
  if (!result.invalid_cells.empty())
    text += fmt::format("{}{} inverted or flat cells remain: {}", text.empty() ? "" : "; ",
                        grouped(result.invalid_cells.size()), id_list(result.invalid_cells));
  if (!result.unfillable_faces.empty())
    text += fmt::format("; at {} boundary faces every mesh with this boundary has such a cell",
                        grouped(result.unfillable_faces.size()));
  else if (!result.folded_faces.empty())
    text += fmt::format(
        "; {} boundary faces lie on or go through one another, and cells without inverted ones were not "
        "found",
        grouped(result.folded_faces.size()));
  const auto n_at_folds = std::count_if(result.stuck.begin(), result.stuck.end(), [](const StuckCell& c) {
    return c.reason == StuckReason::kInputFeature && c.ceiling <= 0;
  });
  if (n_at_folds > 0)
    text +=
        fmt::format("; at {} of them interfaces or labelled faces are folded over one another", n_at_folds);
  if (!result.invalid_cells.empty() && result.surface.unfold_needs > 0)
    text += fmt::format("; the surface is folded over, and {} would let it be unfolded",
                        round_up_option("--hausdorff", result.surface.unfold_needs));
  if (text.empty() && !result.goal_reached)
    text = options.min_dihedral
               ? fmt::format("the goal of {} degrees was not reached for every cell", *options.min_dihedral)
               : "the goal was not reached";
  return text;
}

Json outcome(const TetMesh& mesh, const Result& result) {
  Json json;
  json["changed"] = result.changed;
  json["goal_reached"] = result.goal_reached;
  json["stop"] = stop_name(result.stop);
  json["n_invalid_cells"] = result.invalid_cells.size();
  json["invalid_cells"] = ids(result.invalid_cells);
  json["n_folded_faces"] = result.folded_faces.size();
  json["folded_faces"] = faces_json(mesh, result.folded_faces);
  json["n_unfillable_faces"] = result.unfillable_faces.size();
  json["unfillable_faces"] = faces_json(mesh, result.unfillable_faces);
  json["n_large_stars"] = result.n_large_stars;
  return json;
}

Json device_json(const Result& result) {
  Json json;
  json["name"] = result.device.empty() ? Json() : Json(result.device);
  json["note"] = result.device_note.empty() ? Json() : Json(result.device_note);
  json["seconds_open"] = result.seconds_device;
  json["kernels"] = Json::array();
  for (const KernelTime& time : result.kernel_times)
    json["kernels"].push_back(
        {{"kernel", time.kernel}, {"launches", time.launches}, {"seconds", time.seconds}});
  return json;
}

Result improve_with_progress(TetMesh& mesh, ImproveOptions options, const CommandLine& line,
                             const CommonOptions& common, const SignalGuard& signals) {
  using Style = ProgressView::Style;
  const bool bar = !common.quiet && stderr_is_terminal();
  const Style style = line.progress ? Style::kLines : bar ? Style::kBar : Style::kNone;
  ProgressView view(style);
  // Each call costs improve() a look at every cell, so it is asked for only where it is seen.
  if (style != Style::kNone) options.progress = [&view](const Progress& progress) { view.show(progress); };
  options.cancel = [&signals] { return signals.cancelled(); };
  return improve(mesh, options);
}

/// Kind, index, angle and reason of each cell below the goal, and the folded faces, and those that leave no
/// mesh without invalid cells, by their vertices.
std::string ids_text(const TetMesh& mesh, const Result& result) {
  std::string text = fmt::format(
      "# cells of the output below {:g} degrees: index, degrees, vertices that may "
      "not move, and why\n",
      result.stuck_below);
  for (const StuckCell& stuck : result.stuck)
    text += fmt::format("cell {} {:.4f} {} {}\n", stuck.cell.idx(), stuck.degrees, stuck.n_frozen_vertices,
                        kStuckReasonNames[static_cast<std::size_t>(stuck.reason)]);
  const auto add_faces = [&](const char* kind, const std::vector<HalfFaceHandle>& faces) {
    for (HalfFaceHandle h : faces) {
      const auto f = mesh.halfface_vertices(h);
      text += fmt::format("{} {} {} {}\n", kind, f[0].idx(), f[1].idx(), f[2].idx());
    }
  };
  add_faces("folded", result.folded_faces);
  add_faces("unfillable", result.unfillable_faces);
  return text;
}

/// Wall time by step.
struct Seconds {
  double read = 0, build = 0, statistics = 0, improve = 0, write = 0;
};

void print_result(const Result& result, const Seconds& seconds, const CommandLine& line,
                  const CommonOptions& common) {
  if (common.verbose) print_passes(result.passes);
  print_statistics({{"before", &result.before}, {"after", &result.after}});
  print_limits(result);
  print("{}; seconds: read {:.2f}, build {:.2f}, improve {:.2f}, statistics {:.2f}, write {:.2f}\n",
        result.changed ? "changed" : "unchanged", seconds.read, seconds.build, seconds.improve,
        seconds.statistics, seconds.write);
  if (result.surface.mode != SurfaceMode::kFrozen) print_surface(result.surface);
  if (line.dry_run) print("dry run: nothing was written\n");
}

/// Options that count for nothing without another one.
std::vector<std::string> notes_on_idle_options(const CommandLine& line, bool on_tetrahedra) {
  std::vector<std::string> notes;
  const auto idle = [&](bool given, const char* option, const char* without) {
    if (given) notes.push_back(fmt::format("{} counts only with {}", option, without));
  };
  const bool frozen = on_tetrahedra && (line.surface.empty() || line.surface == "frozen");
  const bool free = line.surface == "free" || (line.surface.empty() && !on_tetrahedra);
  idle(!free && line.hausdorff >= 0, "--hausdorff", "--surface free");
  idle(!free && line.feature_angle, "--feature-angle", "--surface free");
  idle(frozen && !line.fix.empty(), "--fix", "--surface flat or free");
  idle(frozen && !line.periodic.empty(), "--periodic", "--surface flat or free");
  const bool on_cpu = line.device.empty() || line.device == "cpu";
  idle(on_cpu && line.improve.hybrid, "--hybrid", "--device");
  idle(on_cpu && line.improve.device_tuning.work_group > 0, "--work-group", "--device");
  idle(on_cpu && line.improve.device_tuning.profile, "--profile", "--device");
  return notes;
}

/// Everything that stands in the way of a run, and what the user should know of the input.
LoadedMesh load_for_run(io::MeshData data, const CommandLine& line, const ImproveOptions& options,
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

void report_run(Json& report, const TetMesh& mesh, const Result& result, const ImproveOptions& options,
                const Seconds& seconds) {
  report["seconds"] = {{"read", seconds.read},
                       {"build", seconds.build},
                       {"improve", seconds.improve},
                       {"statistics", seconds.statistics},
                       {"write", seconds.write}};
  report["result"] = outcome(mesh, result);
  report["device"] = device_json(result);
  if (options.statistics) {
    report["before"] = to_json(result.before);
    report["after"] = to_json(result.after);
    report["limits"] = limits_json(result);
  }
  if (result.surface.mode != SurfaceMode::kFrozen) report["surface"] = surface_json(result.surface);
  report["passes"] = Json::array();
  for (const PassReport& pass : result.passes) report["passes"].push_back(to_json(pass));
}

/// A file of triangles only.
ExitCode run_on_surface(io::MeshData data, const CommandLine& line, const ImproveOptions& options,
                        const io::WriteOptions& write_options, double seconds_read,
                        const CommonOptions& common, Json& report) {
  const auto add = [&](std::vector<std::string> more) {
    data.notes.insert(data.notes.end(), more.begin(), more.end());
  };
  if (line.ignore_labels) add(drop_labels(data));
  add(notes_on_idle_options(line, false));
  return improve_surface({line.input, line.output, line.dry_run, line.surface, line.min_dihedral,
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
ExitCode run_on_mesh(io::MeshData data, const CommandLine& line, const ImproveOptions& options,
                     const io::WriteOptions& write_options, Seconds seconds, const CommonOptions& common,
                     Json& report) {
  const PointsOfFields points_before(data);
  LoadedMesh loaded = load_for_run(std::move(data), line, options, common);
  seconds.build = loaded.seconds_build;
  report["input"].update(to_json(loaded.report));
  if (line.plan) return print_plan(loaded, options, common, report);

  const SignalGuard signals;  // from here on there is something to save
  const Stopwatch improving;
  const Result result = improve_with_progress(loaded.mesh, options, line, common, signals);
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
  if (!line.dry_run) {
    add(notes_on_replacing(line.output));
    add(save(line.output, data, write_options));
  }
  seconds.write = writing.seconds();
  if (!result.device_note.empty()) notes.push_back("no device, or not to the end: " + result.device_note);

  report["output"].update(contents(data));
  report_run(report, loaded.mesh, result, options, seconds);
  report["notes"] = notes;
  if (!common.quiet) print_notes(notes);
  if (common.prints_table()) print_result(result, seconds, line, common);
  const ExitCode code = exit_code_of(result);
  if (code != ExitCode::kDone) print_error(line.input + ": " + shortfall(result, options));
  return line.ids.empty() ? code : save_report(line.ids, ids_text(loaded.mesh, result), code);
}

ExitCode run(const CommandLine& line, const CommonOptions& common, Json& report) {
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
  if (!line.ids.empty()) require_writable(line.ids);
  const Stopwatch reading;
  io::MeshData data = read_data(line.input, common);
  const double seconds_read = reading.seconds();
  const bool is_surface = data.cells.empty() && !data.triangles.empty();
  if (is_surface && line.plan)
    throw Failure(ExitCode::kUsage, "--plan is for tetrahedra, and " + line.input + " has none");
  if (is_surface)
    return run_on_surface(std::move(data), line, options, write_options, seconds_read, common, report);
  return run_on_mesh(std::move(data), line, options, write_options, {.read = seconds_read}, common, report);
}

/// What is wrong with the argument of --min-dihedral; nothing when it is well.
std::string degrees_or_max(std::string& text) {
  const std::optional<double> degrees = real_of(text);
  if (text == "max" || (degrees && *degrees > 0 && *degrees < kLargestDihedral)) return "";
  return fmt::format("a number of degrees between 0 and {} or 'max' is wanted, not {}", kLargestDihedral,
                     in_quotes(text));
}

}  // namespace

Run add_improve(CLI::App& app, CommonOptions& common) {
  const auto line = std::make_shared<CommandLine>();
  CLI::App* command = app.add_subcommand("improve", "Repair and improve a mesh (the default)");
  command->add_option("IN", line->input, "Mesh to read")
      ->required()
      ->type_name("FILE")
      ->transform(stream_name());
  command->add_option("-o,--output", line->output, "Mesh to write; may be IN")
      ->type_name("FILE")
      ->transform(stream_name());
  add_format_options(*command, common, true, true);
  command->add_flag("--dry-run", line->dry_run, "Report only, write no mesh");
  command->add_flag("--plan", line->plan, "Print the stages and numbers of the run instead of doing it");
  command
      ->add_option(
          "--min-dihedral", line->min_dihedral,
          "Goal for the smallest dihedral angle; only cells that miss it are worked on. 'max': as large "
          "as can be had")
      ->type_name("DEG")
      ->check(CLI::Validator(degrees_or_max, ""));
  command
      ->add_option("--min-angle", line->min_angle,
                   "For a surface without tetrahedra: goal for the smallest angle of its triangles")
      ->type_name("DEG")
      ->check(real_number(0, 60));
  command->add_option("--iterations", line->improve.iterations, "At most N bulk iterations; 0 is no limit")
      ->type_name("N")
      ->check(whole_number(0, std::numeric_limits<int>::max()));
  command->add_option("--time-limit", line->time_limit, "Stop improving after S seconds; exit code 5 then")
      ->type_name("S")
      ->check(positive_number());
  command
      ->add_option("--ops", line->ops,
                   "Operators, comma-separated: edge, face, node, smooth, insert, cluster")
      ->type_name("LIST");
  command->add_flag("--no-insert", line->no_insert, "No new vertices");
  command->add_flag(
      "--bulk-nodes", line->improve.bulk_nodes,
      "Remove vertices in the bulk stage, too: fewer cells, and a lower worst angle on most meshes");
  command
      ->add_option("--min-cells", line->improve.min_cells,
                   "No vertex is removed below N cells; 0: 81 % of the input's, without a bound for 'max'")
      ->type_name("N")
      ->check(whole_number());
  command
      ->add_option("--max-cells", line->improve.max_cells,
                   "No new vertices beyond N cells; 0: 119 % of the input's, without a bound for 'max'")
      ->type_name("N")
      ->check(whole_number());
  command->add_flag(
      "--coarsen", line->improve.coarsen,
      "Remove vertices wherever that makes the worst angles there better, however few cells are "
      "left; --min-cells still holds");
  command->add_option("--ids", line->ids, "Write the cells below the goal and why they are; - is stdout")
      ->type_name("FILE")
      ->transform(stream_name());
  command->add_option("--metric", line->metric, "Quality metric of the bulk passes; volume-length by default")
      ->type_name("NAME");
  command
      ->add_option("--rounds", line->rounds,
                   "auto, by-kind or mixed: kinds of operators in turn, or in one selection")
      ->type_name("NAME");
  command->add_option("--smoother", line->smoother, "newton, candidates, laplacian or taubin")
      ->type_name("NAME");
  command->add_option("--compat", line->compat, "Run a published pipeline exactly: jpdc2013")
      ->type_name("NAME")
      ->check(CLI::IsMember({"jpdc2013"}));
  command
      ->add_option("--surface", line->surface,
                   "What may happen to the surface: frozen (nothing, the default), flat (new triangles in "
                   "planar faces), free (within --hausdorff of the input)")
      ->type_name("MODE")
      ->check(CLI::IsMember({"frozen", "flat", "free"}));
  command
      ->add_option(
          "--hausdorff", line->hausdorff,
          "Largest distance between input and output surface, with --surface free; 0: as flat. Default: "
          "0.3 of the mean edge, at most 0.5 % of the diagonal")
      ->type_name("LENGTH")
      ->check(real_number(0));
  command
      ->add_option("--feature-angle", line->feature_angle,
                   "Edges sharper than this stay, with --surface free; 40 by default")
      ->type_name("DEG")
      ->check(real_number(0, 180));
  command->add_flag("--label-features", line->label_features,
                    "Write sharp edges and corners of the surface as labels");
  command->add_flag("--ignore-labels", line->ignore_labels,
                    "Leave out labels of triangles, edges and vertices that would keep something as it is");
  command
      ->add_option("--fix", line->fix,
                   "Keep as it is: patch:N, vertex:N, edge:N-N or face:N-N-N, counted from 0; repeat, or "
                   "separate by commas")
      ->type_name("WHAT")
      ->delimiter(',');
  command
      ->add_option("--periodic", line->periodic,
                   "Patches A:B that match each other by a translation: their vertices move together")
      ->type_name("A:B")
      ->delimiter(',');
  command
      ->add_option(
          "--device", line->device,
          "Where the large passes run: cpu, auto, opencl or opencl:PLATFORM.DEVICE; the output is the "
          "same everywhere")
      ->type_name("NAME");
  command->add_flag("--hybrid", line->improve.hybrid,
                    "On a device, smooth only, and reconnect on the processor");
  command
      ->add_option("--work-group", line->improve.device_tuning.work_group,
                   "Work-items of a group on a device, a power of two; 0 chooses")
      ->type_name("N")
      ->check(CLI::IsMember({0, 1, 2, 4, 8, 16, 32, 64, 128, 256}));
  command->add_flag("--profile", line->improve.device_tuning.profile,
                    "Measure every kernel; in the JSON report");
  command->add_option("--seed", line->improve.seed, "Seed of the order among equal candidates")
      ->type_name("N")
      ->check(whole_number());
  command->add_flag("--progress", line->progress, "Print progress as lines on stderr");
  add_split_option(*command, common);
  add_write_options(*command, line->write);
  add_common_options(*command, common);
  using Kind = FileUse::Kind;
  return {[line] {
            return std::vector<FileUse>{{Kind::kInput, "IN", line->input},
                                        {Kind::kMesh, "-o", line->dry_run ? "" : line->output},
                                        {Kind::kReport, "--ids", line->ids}};
          },
          [line, &common](Json& report) { return run(*line, common, report); }};
}

}  // namespace hfr::app
