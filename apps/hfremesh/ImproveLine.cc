// SPDX-License-Identifier: BSD-3-Clause
#include "ImproveLine.hh"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "Json.hh"
#include "Locks.hh"
#include "Numbers.hh"

namespace hfr::app {
namespace {

constexpr double kLargestDihedral = 70.5;  // degrees; the regular tetrahedron has 70.53

/// What is wrong with the argument of --min-dihedral; nothing when it is well.
std::string degrees_or_max(std::string& text) {
  const std::optional<double> degrees = real_of(text);
  if (text == "max" || (degrees && *degrees > 0 && *degrees < kLargestDihedral)) return "";
  return fmt::format("a number of degrees between 0 and {} or 'max' is wanted, not {}", kLargestDihedral,
                     in_quotes(text));
}

void add_examples(Command command) {
  command.example("hfremesh bad.mesh -o good.mesh", "inverted cells mended, then quality raised");
  command.example("hfremesh bad.mesh -o bad.mesh --min-dihedral 20",
                  "in place; only cells below 20 degrees are worked on");
  command.example("hfremesh bad.mesh -o good.vtu --min-dihedral max --time-limit 60",
                  "as large an angle as can be had within a minute");
  command.example("hfremesh bad.mesh -o good.mesh --surface free --hausdorff 0.01",
                  "the boundary may move by 0.01 of the mesh's unit");
  command.example("hfremesh bad.mesh -o good.mesh --report run.html",
                  "a page about what was done and what is left");
}

/// What is wanted.
void add_goal_options(Command command, ImproveLine& line) {
  command.group("Goal");
  add_min_dihedral_option(command, line.min_dihedral,
                          "Goal for the smallest dihedral angle; only cells that miss it are worked on. "
                          "'max': as large as can be had");
  command
      .option("--min-angle", line.min_angle,
              "For a surface without tetrahedra: goal for the smallest angle of its triangles")
      .type_name("DEG")
      .check(real_number(0, 60));
  command.option("--time-limit", line.time_limit, "Stop improving after S seconds; exit code 5 then")
      .type_name("S")
      .check(positive_number())
      .shows_default("none");
}

/// How many cells there may be.
void add_bound_options(Command command, ImproveLine& line) {
  command.group("Bounds");
  command.flag("--no-insert", line.no_insert, "No new vertices");
  command
      .option(
          "--min-cells", line.improve.min_cells,
          "No vertex is removed below N cells; 0: 81 % of the input's, without a bound where the surface may "
          "change")
      .type_name("N")
      .shows_default()
      .check(whole_number());
  command
      .option("--max-cells", line.improve.max_cells,
              "No new vertices beyond N cells; 0: 119 % of the input's, 150 % with --surface free, or flat "
              "without a goal")
      .type_name("N")
      .shows_default()
      .check(whole_number());
  command.flag("--coarsen", line.improve.coarsen,
               "Remove vertices wherever that makes the worst angles there better, however few cells are "
               "left; --min-cells still holds");
}

/// How it is done.
void add_method_options(Command command, ImproveLine& line) {
  command.group("Advanced");
  add_ops_option(command, line.ops);
  command.option("--iterations", line.improve.iterations, "At most N iterations of each stage; 0 is no limit")
      .type_name("N")
      .check(whole_number(0, std::numeric_limits<int>::max()))
      .shows_default();
  command.flag("--bulk-nodes", line.improve.bulk_nodes,
               "Remove vertices in the bulk stage, too: fewer cells, and a lower worst angle on most meshes");
  command.flag(
      "--polish-only", line.improve.polish_only,
      "With --min-dihedral: work on the cells that miss it until nothing helps any more, and no further");
  command.flag("--passes-only", line.improve.passes_only,
               "Passes over the mesh alone, without searching for the last few cells: less time, and a lower "
               "worst angle on hard meshes");
  command.option("--metric", line.metric, "Quality metric of the bulk passes; an unknown name lists them")
      .type_name("NAME")
      .shows_default("volume-length");
  add_rounds_option(command, line.rounds);
  command.option("--smoother", line.smoother, "newton, candidates, laplacian or taubin")
      .type_name("NAME")
      .shows_default("newton");
  command.option("--compat", line.compat, "Run a published pipeline exactly: jpdc2013")
      .type_name("NAME")
      .one_of({"jpdc2013"});
}

void add_surface_options(Command command, ImproveLine& line) {
  command.group("Surface");
  add_surface_mode_options(command, line.surface);
  command.flag("--label-features", line.label_features,
               "Write sharp edges and corners of the surface as labels");
  command.flag("--ignore-labels", line.ignore_labels,
               "Leave out labels of triangles, edges and vertices that would keep something as it is");
  add_fix_option(command, line.surface.fix);
  command
      .option("--periodic", line.periodic,
              "Patches A:B that match each other by a translation: their vertices move together")
      .type_name("A:B")
      .delimiter(',')
      .one_a_use();
}

void add_device_options(Command command, ImproveLine& line) {
  command
      .option("--device", line.device,
              "Where the large passes run: cpu, auto, opencl or opencl:PLATFORM.DEVICE; the output is the "
              "same everywhere")
      .type_name("NAME")
      .shows_default("cpu");
  command.flag("--hybrid", line.improve.hybrid, "On a device, smooth only, and reconnect on the processor");
  command
      .option("--work-group", line.improve.device_tuning.work_group,
              "Work-items of a group on a device, a power of two; 0 chooses")
      .type_name("N")
      .shows_default()
      .one_of({0, 1, 2, 4, 8, 16, 32, 64, 128, 256});
  command.flag("--profile", line.improve.device_tuning.profile, "Measure every kernel; in the JSON report");
}
}  // namespace

void add_min_dihedral_option(Command command, std::string& degrees, const std::string& what) {
  command.option("--min-dihedral", degrees, what).type_name("DEG").check(degrees_or_max);
}

void set_min_dihedral(const std::string& degrees, ImproveOptions& options) {
  if (degrees == "max")
    options.raise_min_dihedral = true;
  else if (!degrees.empty())
    options.min_dihedral = real_of(degrees);
}

void add_surface_mode_options(Command command, SurfaceLine& line) {
  command
      .option("--surface", line.mode,
              "What may happen to the surface: frozen (nothing), flat (new triangles in "
              "planar faces), free (within --hausdorff of the input)")
      .type_name("MODE")
      .shows_default("frozen")
      .one_of({"frozen", "flat", "free"});
  command
      .option("--hausdorff", line.hausdorff,
              "Largest distance between input and output surface, with --surface free; 0: as flat")
      .type_name("LENGTH")
      .shows_default("0.3 of the mean edge, at most 0.5 % of the diagonal")
      .check(real_number(0));
  command.option("--feature-angle", line.feature_angle, "Edges sharper than this stay, with --surface free")
      .type_name("DEG")
      .shows_default("40")
      .check(real_number(0, 180));
}

void set_surface(const SurfaceLine& line, const std::vector<std::string>& periodic, SurfaceOptions& options) {
  options.mode = line.surface_mode();
  if (line.hausdorff >= 0) options.hausdorff = line.hausdorff;
  if (line.feature_angle) options.feature_angle = *line.feature_angle;
  add_locks(options, line.fix, periodic);
}

void add_fix_option(Command command, std::vector<std::string>& fix) {
  command
      .option("--fix", fix,
              "Keep as it is: patch:N, vertex:N, edge:N-N or face:N-N-N, counted from 0; repeat, or "
              "separate by commas")
      .type_name("WHAT")
      .delimiter(',')
      .one_a_use();
}

void add_ops_option(Command command, std::string& ops) {
  command.option("--ops", ops, "Operators, comma-separated: edge, face, node, smooth, insert, cluster")
      .type_name("LIST")
      .shows_default("all but cluster");
}

void add_rounds_option(Command command, std::string& rounds) {
  command
      .option("--rounds", rounds, "auto, by-kind or mixed: kinds of operators in turn, or in one selection")
      .type_name("NAME")
      .shows_default("auto");
}

void add_improve_options(Command command, ImproveLine& line, CommonOptions& common) {
  add_examples(command);
  command.group("Mesh");
  command.option("IN", line.input, "Mesh to read").required().type_name("FILE").transform(stream_name());
  command.option("-o,--output", line.output, "Mesh to write; may be IN")
      .type_name("FILE")
      .transform(stream_name());
  add_goal_options(command, line);
  add_surface_options(command, line);
  add_bound_options(command, line);
  command.group("Output");
  command.flag("--dry-run", line.dry_run, "Report only, write no mesh");
  command.flag("--plan", line.plan, "Print the stages and numbers of the run instead of doing it");
  command.option("--ids", line.ids, "Write the cells below the goal and why they are; - is stdout")
      .type_name("FILE")
      .transform(stream_name());
  add_presentation_options(command, line.presentation, "--report");
  command
      .option("--quality-array", line.quality_array,
              "Write the smallest dihedral of each cell, in degrees, as a field of this name")
      .type_name("NAME");
  command.flag("--progress", line.progress, "Print progress as lines on stderr");
  add_method_options(command, line);
  add_device_options(command, line);
  command.option("--seed", line.improve.seed, "Seed of the order among equal candidates")
      .type_name("N")
      .check(whole_number())
      .shows_default();
  add_format_options(command, common, true, true);
  add_split_option(command, common);
  add_write_options(command, line.write);
  add_common_options(command, common);
}

ImproveOptions improve_options(const ImproveLine& line, const CommonOptions& common) {
  ImproveOptions options = line.improve;
  if (!line.ops.empty()) options.ops = ops_from_list(line.ops);
  set_min_dihedral(line.min_dihedral, options);
  if (line.no_insert) options.ops = without(options.ops, Ops::kInsert);
  if (!line.metric.empty()) options.metric = metric_from_name(line.metric);
  if (!line.smoother.empty()) options.smoother = smoother_from_name(line.smoother);
  if (!line.rounds.empty()) options.rounds = rounds_from_name(line.rounds);
  if (!line.compat.empty()) options.compat = Compat::kJpdc2013;
  if (!line.device.empty()) options.device = device_choice_from_name(line.device);
  if (line.time_limit > 0) options.time_limit = line.time_limit;
  set_surface(line.surface, line.periodic, options.surface);
  options.policy = common.policy();
  options.statistics =
      common.prints_table() || !common.json.empty() || !line.ids.empty() || line.presentation.any();
  return options;
}

Json options_json(const ImproveLine& line, const ImproveOptions& options) {
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
  json["surface"] = line.surface.mode.empty() ? "frozen" : line.surface.mode;
  json["device"] = line.device.empty() ? "cpu" : line.device;
  json["hybrid"] = options.hybrid;
  json["bulk_nodes"] = options.bulk_nodes;
  json["polish_only"] = options.polish_only;
  json["passes_only"] = options.passes_only;
  json["seed"] = options.seed;
  json["ignore_labels"] = line.ignore_labels;
  json["dry_run"] = line.dry_run;
  return json;
}

std::vector<std::string> notes_on_idle_surface_options(const SurfaceLine& line, bool has_distance,
                                                       const char* where, bool is_frozen) {
  std::vector<std::string> notes;
  const auto idle = [&](bool given, const char* option, const char* without) {
    if (given) notes.push_back(fmt::format("{} counts only with {}", option, without));
  };
  idle(!has_distance && line.hausdorff >= 0, "--hausdorff", where);
  idle(!has_distance && line.feature_angle, "--feature-angle", where);
  const auto is_patch = [](const std::string& what) { return what.starts_with("patch:"); };
  idle(is_frozen && std::ranges::any_of(line.fix, is_patch), "--fix patch", "--surface flat or free");
  return notes;
}

std::vector<std::string> notes_on_idle_options(const ImproveLine& line, bool on_tetrahedra) {
  const SurfaceMode mode =
      line.surface.surface_mode(on_tetrahedra ? SurfaceMode::kFrozen : SurfaceMode::kFree);
  const bool frozen = on_tetrahedra && mode == SurfaceMode::kFrozen;
  std::vector<std::string> notes =
      notes_on_idle_surface_options(line.surface, mode == SurfaceMode::kFree || line.label_features,
                                    "--surface free or --label-features", frozen);
  const auto idle = [&](bool given, const char* option, const char* without) {
    if (given) notes.push_back(fmt::format("{} counts only with {}", option, without));
  };
  const auto left_out = [&](bool given, const char* option, const char* by) {
    if (given) notes.push_back(fmt::format("{} does nothing with {}", option, by));
  };
  idle(frozen && !line.periodic.empty(), "--periodic", "--surface flat or free");
  const int usual_width = PresentationFiles{}.png_width;
  idle(line.presentation.png.empty() && line.presentation.png_width != usual_width, "--png-width", "--png");
  const bool on_cpu = line.device.empty() || line.device == "cpu";
  idle(on_cpu && line.improve.hybrid, "--hybrid", "--device");
  idle(on_cpu && line.improve.device_tuning.work_group > 0, "--work-group", "--device");
  idle(on_cpu && line.improve.device_tuning.profile, "--profile", "--device");
  if (!on_tetrahedra) {
    constexpr const char* kSurface = "a surface without cells";
    left_out(line.no_insert, "--no-insert", kSurface);
    left_out(line.improve.min_cells > 0, "--min-cells", kSurface);
    left_out(line.improve.max_cells > 0, "--max-cells", kSurface);
    left_out(line.improve.coarsen, "--coarsen", kSurface);
    left_out(line.improve.iterations > 0, "--iterations", kSurface);
    left_out(!on_cpu, "--device", kSurface);
    left_out(!line.metric.empty(), "--metric", kSurface);
    left_out(!line.ops.empty(), "--ops", kSurface);
    left_out(!line.smoother.empty(), "--smoother", kSurface);
    left_out(!line.rounds.empty(), "--rounds", kSurface);
    left_out(!line.compat.empty(), "--compat", kSurface);
    left_out(line.improve.bulk_nodes, "--bulk-nodes", kSurface);
    left_out(line.improve.polish_only, "--polish-only", kSurface);
    left_out(line.improve.passes_only, "--passes-only", kSurface);
    left_out(line.label_features, "--label-features", kSurface);
    left_out(line.improve.seed != ImproveOptions().seed, "--seed", kSurface);
    left_out(line.progress, "--progress", kSurface);
    return notes;
  }
  if (!line.compat.empty()) {  // a published pipeline, as it is
    left_out(!frozen, "--surface", "--compat");
    left_out(line.improve.coarsen, "--coarsen", "--compat");
    left_out(line.improve.bulk_nodes, "--bulk-nodes", "--compat");
    left_out(line.improve.polish_only, "--polish-only", "--compat");
    left_out(line.improve.passes_only, "--passes-only", "--compat");
    left_out(!line.metric.empty(), "--metric", "--compat");
    left_out(!line.rounds.empty(), "--rounds", "--compat");
    left_out(!line.smoother.empty(), "--smoother", "--compat");
    if (!line.min_dihedral.empty())
      notes.push_back("--min-dihedral is not worked for with --compat: it is only looked at in the end");
  } else if (line.improve.polish_only) {
    left_out(line.improve.bulk_nodes, "--bulk-nodes", "--polish-only");
    left_out(!line.metric.empty(), "--metric", "--polish-only");
    left_out(line.improve.passes_only, "--passes-only", "--polish-only");
  }
  return notes;
}

}  // namespace hfr::app
