// SPDX-License-Identifier: BSD-3-Clause
// hfremesh-mpi parts: a mesh that is in parts from beginning to end, generated or read, improved, checked,
// written.
#include "InParts.hh"

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "ExitCode.hh"
#include "Fields.hh"
#include "Files.hh"
#include "ImproveLine.hh"
#include "Json.hh"
#include "Numbers.hh"
#include "Options.hh"
#include "Parser.hh"
#include "Paths.hh"
#include "PrintFigures.hh"
#include "Report.hh"
#include "Signals.hh"
#include "hfremesh/Distributed/InParts.hh"
#include "hfremesh/HalfFace/Config.hh"
#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::app {
namespace {

struct PartsLine {
  std::string input, output;
  std::vector<Index> counts;  ///< of the grid, where one is to be generated
  double jitter = 0.2;
  double amplitude = 0;
  std::string min_dihedral;  ///< degrees or "max"
  std::string ops, rounds;
  bool no_insert = false;
  bool all_stages = false, passes_only = false, coarsen = false, bulk_nodes = false;
  int iterations = 0;
  std::size_t min_cells = 0, max_cells = 0;
  double time_limit = 0;  ///< seconds; 0 = none
  SurfaceLine surface;
  std::uint64_t seed = 2013;
  int threads_each = 1;
  std::string partition = "coordinates";
  bool distributed_output = false;
  std::string json;  ///< file for the report, "-" for stdout, empty for none
  bool shows_traffic = false;
  bool quiet = false;

  bool prints() const { return !quiet && json != "-"; }
  bool goes_over_all() const { return all_stages || passes_only || coarsen || min_dihedral == "max"; }
  bool improves() const { return !min_dihedral.empty() || goes_over_all(); }
  /// Options of a run, where there is none.
  bool has_idle_options() const {
    return !improves() &&
           (!ops.empty() || !rounds.empty() || no_insert || bulk_nodes || iterations > 0 || min_cells > 0 ||
            max_cells > 0 || time_limit > 0 || !surface.mode.empty() || !surface.fix.empty());
  }
};

void add_options(Command command, PartsLine& line) {
  command.example("mpirun -n 4 hfremesh-mpi parts --generate 150 150 150 -o bad.pvtu", "20 million cells");
  command.example("mpirun -n 4 hfremesh-mpi parts bad.pvtu -o good.pvtu --min-dihedral 15",
                  "with the bits of hfremesh --polish-only");
  command.example("mpirun -n 4 hfremesh-mpi parts bad.pvtu -o good.vtu --all-stages",
                  "all cells, with the bits of hfremesh");
  command.example("mpirun -n 4 hfremesh-mpi parts part.msh -o part.vtu --min-dihedral 15",
                  "a file of which no rank reads all");
  command.example("mpirun -n 3 hfremesh-mpi parts good.pvtu -o good.msh", "one file, written by all ranks");
  command.example(
      "mpirun -n 4 hfremesh-mpi parts part.mesh -o out.mesh --distributed-output --min-dihedral 15",
      "part.0.mesh and so on, to out.0.mesh and so on, for ParMmg");
  command.option(
      "IN", line.input,
      "What to read: .pvtu, an index of pieces; .vtu, .mesh, .meshb or .msh, of which each rank "
      "reads a range; or, where there is no file name.mesh, ParMmg's name.0.mesh, name.1.mesh and so on");
  command
      .option("-o,--output", line.output,
              "What to write: .pvtu, with a piece for each rank, or .vtu, .mesh, .meshb or .msh, one file "
              "with the bytes of hfremesh")
      .type_name("FILE");
  command.flag("--distributed-output", line.distributed_output,
               "With -o name.mesh: a file for each rank, name.0.mesh and so on, as ParMmg reads them");
  add_min_dihedral_option(
      command, line.min_dihedral,
      "Goal for the smallest dihedral angle: the cells that miss it are worked on by edge removal, face "
      "swaps, vertex collapse, smoothing and new vertices, and where --ops has it by cluster search; "
      "inverted and flat cells are mended first. 'max': all stages, and as large as can be had");
  command.flag(
      "--all-stages", line.all_stages,
      "Improve all cells, or with --min-dihedral go on where the work on the cells that miss it does "
      "not do, as hfremesh does");
  command.flag("--passes-only", line.passes_only,
               "The same without the searches for the last few cells, as hfremesh --passes-only");
  command.flag("--coarsen", line.coarsen,
               "All stages, and remove vertices wherever that makes the worst angles there better");
  command.flag("--bulk-nodes", line.bulk_nodes, "Remove vertices where all cells are worked on, too");
  add_ops_option(command, line.ops);
  add_rounds_option(command, line.rounds);
  command.option("--iterations", line.iterations, "At most N iterations of each stage; 0 is no limit")
      .type_name("N")
      .check(whole_number(0, std::numeric_limits<int>::max()));
  command.flag("--no-insert", line.no_insert, "No new vertices");
  command.option("--min-cells", line.min_cells, "No vertex is removed below N cells; 0: 81 % of the input's")
      .type_name("N")
      .check(whole_number());
  command.option("--max-cells", line.max_cells, "No new vertices beyond N cells; 0: 119 % of the input's")
      .type_name("N")
      .check(whole_number());
  command.option("--time-limit", line.time_limit, "Stop improving after S seconds; exit code 5 then")
      .type_name("S")
      .check(positive_number())
      .shows_default("none");
  add_surface_mode_options(command, line.surface);
  add_fix_option(command, line.surface.fix);
  command.option("--threads-each", line.threads_each, "Threads of each rank")
      .type_name("N")
      .shows_default()
      .check(whole_number(1, 1024));
  command.option("--json", line.json, "Write a report in JSON; - is stdout")
      .type_name("FILE")
      .transform(stream_name());
  command.flag("--traffic", line.shows_traffic,
               "Print what ranks have sent, their memory, and seconds by phase");
  command.flag("-q,--quiet", line.quiet, "Print errors only");
  command.group("A grid instead of IN, as hfremesh generate cavity makes it");
  command.option("--generate", line.counts, "Cubes along x, y and z, of 6 cells each")
      .type_name("NX NY NZ")
      .expected(3)
      .check(whole_number(1, std::numeric_limits<Index>::max() - 1));
  command.option("--jitter", line.jitter, "Random move of inner coordinates, in cube widths")
      .type_name("X")
      .shows_default()
      .check(real_number());
  command.option("--amplitude", line.amplitude, "Strength of the deformation; 0 for none")
      .type_name("X")
      .shows_default()
      .check(real_number());
  command.option("--seed", line.seed, "Seed of the jitter")
      .type_name("N")
      .shows_default()
      .check(whole_number());
  command.option("--partition", line.partition, "How the grid is cut: blocks, or slices by number")
      .type_name("HOW")
      .shows_default()
      .one_of({"coordinates", "numbers"});
}

/// Throws Failure for a name that there is not.
ImproveOptions improve_options(const PartsLine& line) {
  ImproveOptions options;
  set_min_dihedral(line.min_dihedral, options);
  options.polish_only = !line.goes_over_all() && options.min_dihedral;
  options.passes_only = line.passes_only;
  options.coarsen = line.coarsen;
  options.bulk_nodes = line.bulk_nodes;
  options.iterations = line.iterations;
  try {
    if (!line.ops.empty()) options.ops = ops_from_list(line.ops);
    if (!line.rounds.empty()) options.rounds = rounds_from_name(line.rounds);
  } catch (const InvalidInput& error) {
    throw Failure(ExitCode::kUsage, std::string("parts: ") + error.what());
  }
  if (line.no_insert) options.ops = without(options.ops, Ops::kInsert);
  options.min_cells = line.min_cells;
  options.max_cells = line.max_cells;
  if (line.time_limit > 0) options.time_limit = line.time_limit;
  set_surface(line.surface, {}, options.surface);
  options.statistics = line.prints() || !line.json.empty();
  options.policy = par::Policy{line.threads_each};
  return options;
}

/// Throws Failure for what no run can have.
void require_sound(const PartsLine& line) {
  const auto extension = [](const std::string& name) {
    return std::filesystem::path(name).extension().string();
  };
  const auto refuse = [](const std::string& why) { throw Failure(ExitCode::kUsage, "parts: " + why); };
  if (line.input.empty() == line.counts.empty()) refuse("give either IN or --generate NX NY NZ");
  const std::string in = extension(line.input);
  const auto is_known = [](const std::string& name) {
    constexpr std::array kKnown = {".pvtu", ".vtu", ".mesh", ".meshb", ".msh"};
    return std::find(kKnown.begin(), kKnown.end(), name) != kKnown.end();
  };
  if (!line.input.empty() && !is_known(in))
    refuse(
        line.input +
        ": meshes in parts are read from .pvtu, .vtu, .mesh, .meshb and .msh; hfremesh-mpi without 'parts' "
        "reads other formats");
  const std::string out = extension(line.output);
  if (!line.output.empty() && !is_known(out))
    refuse(line.output + ": meshes in parts are written as .pvtu, .vtu, .mesh, .meshb or .msh");
  if (line.distributed_output && out != ".mesh") refuse("--distributed-output is for -o FILE.mesh");
  if (line.passes_only && line.min_dihedral == "max")
    refuse(
        "--min-dihedral max searches for the last cells, which --passes-only leaves out: give one of them");
  improve_options(line);
}

/// Before anything is read: a run of hours ends with files that can be written.
void look_at_files(const PartsLine& line, int n_ranks) {
  using Kind = FileUse::Kind;
  const std::filesystem::path output(line.output);
  const bool in_pieces = output.extension() == ".pvtu";
  std::vector<std::string> outputs, parts_of_output;
  if (!line.distributed_output) outputs.push_back(line.output);
  for (int r = 0; r < n_ranks && (in_pieces || line.distributed_output); ++r)
    parts_of_output.push_back(mpi::part_path(output, r).string());
  std::vector<FileUse> uses = {{Kind::kInput, "IN", line.input}};
  for (int r = 0; !line.input.empty() && !std::filesystem::exists(line.input); ++r) {
    const std::string part = mpi::part_path(line.input, r).string();
    if (!std::filesystem::exists(part)) break;
    uses.push_back({Kind::kInput, "IN", part});
  }
  for (const std::string& path : outputs) uses.push_back({Kind::kMesh, "-o", path});
  // They are apart from each other by their numbers, and what is read may be replaced.
  for (const std::string& path : parts_of_output) uses.push_back({Kind::kInput, "-o", path});
  uses.push_back({Kind::kReport, "--json", line.json});
  require_apart(uses, {});
  outputs.push_back(line.json);
  const std::filesystem::path folder = in_pieces ? mpi::part_path(output, 0).parent_path() : "";
  if (in_pieces && std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    throw Failure(ExitCode::kUsage,
                  fmt::format("{}: is no folder, where the pieces of {} go", folder.string(), line.output));
  if (!in_pieces || std::filesystem::exists(folder))
    outputs.insert(outputs.end(), parts_of_output.begin(), parts_of_output.end());
  for (const std::string& path : outputs)
    if (!path.empty()) require_writable(path);
}

class PartsRun {
 public:
  /// `report`: of rank 0.
  PartsRun(const PartsLine& line, mpi::Comm& comm, Json& report)
      : line_(line), comm_(comm), report_(report), mesh_(comm) {}

  ExitCode run() {
    begin_report();
    begin();
    const char* const step = line_.input.empty() ? "generate" : "read";
    mpi::InParts found = mpi::survey(mesh_, goal(), policy());
    say_found(line_.input.empty() ? "generated" : "read", found, note_seconds(step));
    report_["before"] = json_of(found);
    report_["after"] = json_of(found);
    if (!line_.input.empty()) {
      if (!mpi::check(mesh_).is_good) {
        pinched_ = mpi::pinches(mesh_);
        require_good(ExitCode::kCannotRead, line_.input + ": meshes in parts cannot have");
      }
      note_seconds("check");
    }
    bool goal_reached = true, is_out_of_time = false;
    mpi::RankFigures figures;
    if (line_.has_idle_options()) {
      constexpr const char* kIdle =
          "nothing is improved: give --min-dihedral, --all-stages, --passes-only or --coarsen";
      say("{}", kIdle);
      report_["notes"].push_back(kIdle);
    }
    const SurfaceMode mode = line_.surface.surface_mode();
    for (const std::string& note : notes_on_idle_surface_options(
             line_.surface, mode == SurfaceMode::kFree, "--surface free", mode == SurfaceMode::kFrozen)) {
      say("{}", note);
      report_["notes"].push_back(note);
    }
    if (line_.improves()) {
      const mpi::PartsResult result = improve();
      found = result.after;
      figures = result.mine;
      goal_reached = result.goal_reached;
      is_out_of_time = result.stop == Stop::kTimeLimit;
      note_values_elsewhere(result.after.n_vertices);
    }
    check();
    if (!line_.output.empty()) write();
    say_memory();
    if (line_.shows_traffic) {
      const std::vector<mpi::RankFigures> of_ranks = mpi::gather_figures(comm_, figures);
      if (comm_.rank() == 0) print_figures(of_ranks);
    }
    if (is_out_of_time && !goal_reached) {
      complain("the time limit was met; the mesh is the best so far");
      return ExitCode::kLimit;
    }
    if (found.n_invalid > 0) {
      complain("{} cells are inverted or flat", grouped(found.n_invalid));
      return ExitCode::kInvalidCells;
    }
    if (goal_reached) return ExitCode::kDone;
    complain("the smallest dihedral angle is {:.4f}, below the goal of {:g}", found.min_dihedral, goal());
    return ExitCode::kGoalMissed;
  }

 private:
  par::Policy policy() const { return par::Policy{line_.threads_each}; }
  /// Degrees; 0 where there is none.
  double goal() const { return improve_options(line_).min_dihedral.value_or(0); }
  template <class... Values>
  void say(fmt::format_string<Values...> text, Values&&... values) const {
    if (comm_.rank() != 0 || !line_.prints()) return;
    fmt::print("{}\n", fmt::format(text, std::forward<Values>(values)...));
    std::fflush(stdout);
  }
  template <class... Values>
  void complain(fmt::format_string<Values...> text, Values&&... values) const {
    if (comm_.rank() != 0) return;
    fmt::print(stderr, "hfremesh-mpi: {}: {}\n", line_.input.empty() ? "the grid" : line_.input,
               fmt::format(text, std::forward<Values>(values)...));
  }
  /// Those of all ranks, each once: whatever rank has met it.
  void say_notes(const std::string& path, const std::vector<std::string>& notes) {
    std::string mine;
    for (const std::string& note : notes) mine += note + "\n";
    const std::vector<char> all = comm_.all_gather(std::span<const char>(mine));
    std::set<std::string> lines;
    for (auto at = all.begin(); at != all.end();) {
      const auto end = std::find(at, all.end(), '\n');
      lines.emplace(at, end);
      at = end + 1;
    }
    for (const std::string& note : lines) {
      say("{}: {}", path, note);
      report_["notes"].push_back(path + ": " + note);
    }
  }

  void begin_report() {
    report_["ranks"] = comm_.size();
    report_["threads"] = policy().threads;
    report_["notes"] = Json::array();
    if (!line_.input.empty())
      report_["input"] = {{"file", line_.input}};
    else
      report_["grid"] = {{"counts", line_.counts},
                         {"jitter", line_.jitter},
                         {"amplitude", line_.amplitude},
                         {"seed", line_.seed}};
    const ImproveOptions options = improve_options(line_);
    Json wanted = options.raise_min_dihedral ? Json("max") : Json();
    if (options.min_dihedral) wanted = *options.min_dihedral;
    report_["options"] = {{"min_dihedral", std::move(wanted)},
                          {"ops", ops_to_list(options.ops)},
                          {"polish_only", options.polish_only},
                          {"surface", line_.surface.mode.empty() ? "frozen" : line_.surface.mode},
                          {"passes_only", options.passes_only},
                          {"coarsen", options.coarsen},
                          {"bulk_nodes", options.bulk_nodes},
                          {"iterations", options.iterations},
                          {"time_limit", line_.time_limit > 0 ? Json(line_.time_limit) : Json()},
                          {"rounds", line_.rounds.empty() ? Json() : Json(line_.rounds)},
                          {"min_cells", line_.min_cells > 0 ? Json(line_.min_cells) : Json()},
                          {"max_cells", line_.max_cells > 0 ? Json(line_.max_cells) : Json()}};
  }
  static Json json_of(const mpi::InParts& found) {
    Json below;
    for (std::size_t k = 0; k < found.n_below.size(); ++k)
      below[fmt::format("{:g}", mpi::kCountedBelow[k])] = found.n_below[k];
    return {{"vertices", found.n_vertices},
            {"cells", found.n_cells},
            {"boundary_faces", found.n_boundary_faces},
            {"invalid", found.n_invalid},
            {"min_dihedral", found.min_dihedral},
            {"cells_below", std::move(below)},
            {"most_held", found.most_held}};
  }
  /// Of a step that has ended, which may come more than once.
  double note_seconds(const char* step) {
    const double taken = seconds();
    Json& all = report_["seconds"][step];
    all = (all.is_null() ? 0 : all.get<double>()) + taken;
    return taken;
  }
  double seconds() {
    const auto now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(since_, now)).count();
  }

  /// What the library finds wrong with a file ends the run with this code, as in the tool.
  template <class Use>
  static void reporting(ExitCode code, Use&& use) {
    try {
      use();
    } catch (const InvalidInput& error) {
      throw Failure(code, error.what());
    } catch (const IoError& error) {
      throw Failure(code, error.what());
    }
  }

  void begin() {
    if (!line_.input.empty()) {
      reporting(ExitCode::kCannotRead, [&] { say_notes(line_.input, read()); });
      return;
    }
    mpi::GridOptions grid;
    grid.cavity.counts = {line_.counts[0], line_.counts[1], line_.counts[2]};
    grid.cavity.jitter = line_.jitter;
    grid.cavity.amplitude = line_.amplitude;
    grid.cavity.seed = line_.seed;
    mpi::generate_in_parts(
        mesh_, grid, line_.partition == "numbers" ? mpi::Partition::kNumbers : mpi::Partition::kCoordinates);
  }

  std::vector<std::string> read() {
    if (std::filesystem::path(line_.input).extension() == ".pvtu") return mpi::read_pvtu(mesh_, line_.input);
    if (mpi::has_medit_parts(comm_, line_.input)) return mpi::read_medit_parts(mesh_, line_.input);
    return mpi::read_ranges(mesh_, line_.input);
  }

  mpi::PartsResult improve() {
    mpi::PartsResult result;
    reporting(ExitCode::kUsage, [&] { result = mpi::improve(mesh_, improve_options(line_)); });
    say_found("improved", result.after, note_seconds("improve"));
    report_["after"] = json_of(result.after);
    if (result.surface.mode != SurfaceMode::kFrozen) {
      report_["surface"] = surface_json(result.surface);
      if (comm_.rank() == 0 && line_.prints()) print_surface(result.surface);
    }
    report_["result"] = {{"changed", result.changed},
                         {"goal_reached", result.goal_reached},
                         {"stop", stop_name(result.stop)},
                         {"n_below_goal", result.after.n_below_goal},
                         {"has_fallen", result.has_fallen}};
    Json& passes = report_["passes"] = Json::array();
    for (const PassReport& pass : result.passes) passes.push_back(to_json(pass));
    if (goal() > 0 && !result.goal_reached)
      say("  {} cells are below {:g} degrees", grouped(result.after.n_below_goal), goal());
    if (result.has_fallen) say("  the smallest angle has fallen; hfremesh would have put the input back");
    return result;
  }

  void note_values_elsewhere(std::uint64_t n_vertices) {
    const mpi::AttachedToPoints attached = mpi::attached_to_points(mesh_);
    if (attached.n_elsewhere == 0) return;
    const std::string note = note_on_values_elsewhere(attached.names, attached.n_elsewhere, n_vertices);
    say("{}", note);
    report_["notes"].push_back(note);
  }

  void require_good(ExitCode otherwise, const std::string& what) {
    const mpi::PartsCheck checked = mpi::check(mesh_, pinched_);
    if (!checked.is_good)
      throw Failure(otherwise, fmt::format("{}: {} (rank {})", what, checked.message, checked.rank));
  }

  void check() {
    require_good(ExitCode::kInternal, "the check has found");
    say("checked on {} ranks: no fault, {:.2f} s", comm_.size(), note_seconds("check"));
  }

  void write() {
    reporting(ExitCode::kUsage, [&] {
      if (std::filesystem::path(line_.output).extension() == ".pvtu")
        return mpi::write_pvtu(mesh_, line_.output);
      say_notes(line_.output, line_.distributed_output ? mpi::write_medit_parts(mesh_, line_.output)
                                                       : mpi::write_ranges(mesh_, line_.output));
    });
    report_["output"] = {{"file", line_.output}};
    say("written {}, {:.2f} s", line_.output, note_seconds("write"));
  }

  void say_found(const char* what, const mpi::InParts& found, double taken) const {
    std::string below;
    for (std::size_t k = 0; k < found.n_below.size(); ++k)
      below +=
          fmt::format("{}{} below {:g}", k > 0 ? ", " : "", grouped(found.n_below[k]), mpi::kCountedBelow[k]);
    say("{}: {} cells, {} vertices, {} boundary faces, {:.2f} s", what, grouped(found.n_cells),
        grouped(found.n_vertices), grouped(found.n_boundary_faces), taken);
    say("  smallest dihedral {:.6g} degrees; {} invalid, {}", found.min_dihedral, grouped(found.n_invalid),
        below);
    say("  a rank holds {} cells at most", grouped(found.most_held));
  }

  void say_memory() {
    const std::uint64_t mine = mpi::peak_bytes(), sum = comm_.sum(mine);
    if (sum == 0) return;
    const double most = -comm_.min(-static_cast<double>(mine));
    report_["memory"] = {{"most", static_cast<std::uint64_t>(most)}, {"all", sum}};
    say("memory: {:.0f} MB on the rank that took most, {:.0f} MB on all", most / 1e6,
        static_cast<double>(sum) / 1e6);
  }

  using Clock = std::chrono::steady_clock;

  const PartsLine& line_;
  mpi::Comm& comm_;
  Json& report_;
  mpi::DistributedMesh mesh_;
  mpi::Pinches pinched_;  // of the input
  Clock::time_point since_ = Clock::now();
};

/// Nothing where help was asked for. All ranks have the same line; the first one prints what is wrong with
/// it.
std::optional<PartsLine> parse(int argc, char** argv) {
  PartsLine line;
  Parser parser("hfremesh-mpi", "Meshes in parts, on all ranks", "hfremesh-mpi " + std::string(HFR_VERSION));
  Command command = parser.program().subcommand(
      "parts", "A mesh that no rank holds alone: generate or read, improve, check, write");
  add_options(command, line);
  if (!parser.parse({argv + 1, argv + argc})) return std::nullopt;
  require_sound(line);
  return line;
}

}  // namespace

bool is_in_parts(int argc, char** argv) { return argc > 1 && std::string_view(argv[1]) == "parts"; }

int run_in_parts(int argc, char** argv, mpi::Comm& comm) {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 20);  // as the tool does; see Tool.cc
#endif
  handle_signals();  // which leave no temporary file
  std::optional<PartsLine> line;
  Json report = new_report("parts");
  const auto finish = [&](int code) {
    if (comm.rank() != 0 || !line || line->json.empty()) return code;
    report["exit_code"] = code;
    return static_cast<int>(save_report(
        line->json, [&] { return json_text(report); }, static_cast<ExitCode>(code)));
  };
  const auto end = [&](const mpi::RankFailed& failed) {
    if (comm.rank() == 0) fmt::print(stderr, "hfremesh-mpi: {}\n", failed.what());
    report["error"] = failed.what();
    return finish(failed.code());
  };
  try {
    int code = 0;
    if (comm.rank() == 0) try {
        line = parse(argc, argv);
        if (line) look_at_files(*line, comm.size());
      } catch (const Failure& failure) {
        line.reset();
        fmt::print(stderr, "hfremesh-mpi: {}\n", failure.what());
        code = static_cast<int>(failure.code());
      }
    const std::array<int, 2> said = comm.from_first(std::array<int, 2>{line ? 1 : 0, code});
    if (said[0] == 0) return said[1];
    if (comm.rank() != 0) line = parse(argc, argv);
    return finish(static_cast<int>(PartsRun(*line, comm, report).run()));
  } catch (const mpi::RankFailed& failed) {
    return end(failed);
  } catch (const std::exception& error) {
    return end(comm.fail(static_cast<int>(exit_code_of(error)), message_of(error)));
  }
}

}  // namespace hfr::app
