// SPDX-License-Identifier: BSD-3-Clause
// hfremesh move IN --displacement FIELD -o OUT: one step of a simulation, from file to file. With --series,
// all the steps of one.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "Commands.hh"
#include "Console.hh"
#include "Files.hh"
#include "ImproveReport.hh"
#include "Json.hh"
#include "Numbers.hh"
#include "Report.hh"
#include "Signals.hh"
#include "hfremesh/IO/Assemble.hh"
#include "hfremesh/IO/OutputFile.hh"
#include "hfremesh/Remesh/Remesher.hh"

namespace hfr::app {
namespace {

struct MoveLine {
  std::string input, output, displacement, series;
  std::vector<std::string> transfer;
  double goal = 15, trigger = 10, time_limit = 0;
  std::string trigger_field;
  std::string on_inversion = "repair", motion = "given", surface = "frozen";
  io::WriteOptions write;
};

template <class T, std::size_t N>
T named(const std::array<std::pair<const char*, T>, N>& names, const std::string& name) {
  for (const auto& [known, value] : names)
    if (name == known) return value;
  throw Failure(ExitCode::kInternal, "no such name: " + name);  // the parser knows them all
}

constexpr std::array<std::pair<const char*, OnInversion>, 3> kOnInversion = {
    {{"repair", OnInversion::kRepair},
     {"substeps", OnInversion::kSubsteps},
     {"refuse", OnInversion::kRefuse}}};
constexpr std::array<std::pair<const char*, Motion>, 3> kMotions = {
    {{"given", Motion::kGiven}, {"laplace", Motion::kLaplace}, {"elastic", Motion::kElastic}}};
constexpr std::array<std::pair<const char*, SurfaceMode>, 3> kSurfaces = {
    {{"frozen", SurfaceMode::kFrozen}, {"flat", SurfaceMode::kFlat}, {"free", SurfaceMode::kFree}}};
constexpr std::array<const char*, 9> kCauses = {"none",      "inverted", "angle", "metric", "jacobian",
                                                "indicator", "motion",   "steps", "asked"};

/// NAME:linear, NAME:quadratic, NAME:inherit, NAME:conserve or NAME:conserve:DENSITY. The name may have
/// colons.
FieldTransfer field_transfer(const std::string& text) {
  const auto parts = [](const std::string& whole) {
    const std::size_t at = whole.rfind(':');
    return at == std::string::npos ? std::pair(whole, std::string())
                                   : std::pair(whole.substr(0, at), whole.substr(at + 1));
  };
  const auto [name, last] = parts(text);
  const auto [inner, how] = parts(name);
  try {
    if (how == "conserve" && last != "linear" && last != "quadratic" && last != "inherit" &&
        last != "conserve")
      return {.name = inner, .how = Transfer::kConserve, .density = last};
    return {.name = name, .how = transfer_from_name(last)};
  } catch (const InvalidInput&) {
    throw Failure(ExitCode::kUsage, "--transfer " + in_quotes(text) +
                                        ": NAME:linear, NAME:quadratic, NAME:inherit, NAME:conserve or "
                                        "NAME:conserve:DENSITY is wanted");
  }
}

/// What is asked for, and else each field by its kind: those of vertices linear, those of cells inherited.
std::vector<FieldTransfer> fields_of(const TetMesh& mesh, const MoveLine& line) {
  std::vector<FieldTransfer> fields;
  for (const std::string& text : line.transfer) fields.push_back(field_transfer(text));
  const auto add = [&](const std::string& name, Transfer how) {
    const bool known = std::any_of(fields.begin(), fields.end(), [&](const FieldTransfer& f) {
      return f.name == name && is_of_vertices(f.how) == is_of_vertices(how);
    });
    if (known) return;
    const FieldTransfer field{.name = name, .how = how};
    try {
      validate_fields(mesh, {&field, 1});
    } catch (const InvalidInput&) {
      return;  // integers at vertices: attached, as `improve` leaves them
    }
    fields.push_back(field);
  };
  for (const std::string& name : mesh.properties().vertices.names()) add(name, Transfer::kLinear);
  for (const std::string& name : mesh.properties().cells.names()) add(name, Transfer::kInherit);
  return fields;
}

RemesherOptions remesher_options(const MoveLine& line, const CommonOptions& common,
                                 const SignalGuard& signals) {
  RemesherOptions options;
  options.improve.min_dihedral = line.goal;
  options.improve.policy = common.policy();
  options.improve.surface.mode = named(kSurfaces, line.surface);
  if (line.time_limit > 0) options.improve.time_limit = line.time_limit;
  options.improve.cancel = [&signals] { return signals.cancelled(); };
  options.triggers.min_dihedral = line.trigger;
  options.triggers.indicator_field = line.trigger_field;
  options.on_inversion = named(kOnInversion, line.on_inversion);
  options.motion = named(kMotions, line.motion);
  return options;
}

Json step_json(const StepResult& step, const TetMesh& mesh) {
  Json out;
  out["cause"] = kCauses[static_cast<std::size_t>(step.cause)];
  out["fraction"] = step.fraction;
  out["cells_looked_at"] = step.n_looked_at;
  out["refused"] = ids(step.refused);
  out["cells"] = mesh.n_cells();
  out["vertices"] = mesh.n_vertices();
  out["min_dihedral"] = step.min_dihedral;
  out["inverted"] = step.n_inverted;
  out["undone"] = step.undone;
  out["repairs"] = Json::array();
  for (const RepairResult& repair : step.repairs) {
    Json& one = out["repairs"].emplace_back();
    one["stop"] = stop_name(repair.stop);
    one["goal_reached"] = repair.goal_reached;
    one["cells_removed"] = repair.edits.removed_cells.size();
    one["cells_created"] = repair.edits.created_cells.size();
    one["vertices_removed"] = repair.edits.removed_vertices.size();
    one["vertices_created"] = repair.edits.created_vertices.size();
    one["vertices_moved"] = repair.edits.moved_vertices.size();
    one["fields"] = Json::array();
    for (const FieldReport& field : repair.fields)
      one["fields"].push_back({{"name", field.name},
                               {"changed", field.n_changed},
                               {"outside", field.n_outside},
                               {"integral", field.integral},
                               {"lost", field.lost}});
  }
  return out;
}

/// The code to end with, and a line that says why it is not 0.
struct Ending {
  ExitCode code = ExitCode::kDone;
  std::string why;
};

Ending ending_of(const StepResult& step, const MoveLine& line) {
  if (!step.refused.empty())
    return {ExitCode::kInvalidCells, fmt::format("the move would invert {} cells and was refused: {}",
                                                 step.refused.size(), id_list(step.refused))};
  if (step.stop == Stop::kCancelled) return {ExitCode::kCancelled, "cancelled"};
  if (step.stop == Stop::kTimeLimit) return {ExitCode::kLimit, "the time limit was met"};
  if (step.n_inverted > 0)
    return {ExitCode::kInvalidCells, fmt::format("{} cells are inverted or flat", step.n_inverted)};
  if (step.min_dihedral < line.trigger)
    return {ExitCode::kGoalMissed,
            fmt::format("the smallest dihedral is {:.2f} degrees, below the trigger of {}", step.min_dihedral,
                        line.trigger)};
  return {};
}

void print_step(const std::string& name, const StepResult& step, const TetMesh& mesh) {
  std::size_t created = 0;
  for (const RepairResult& repair : step.repairs) created += repair.edits.created_cells.size();
  print("{:<24} {:>10} cells  {:>6.2f} degrees  {:<9} {:>8} cells new\n", name, grouped(mesh.n_cells()),
        step.min_dihedral, kCauses[static_cast<std::size_t>(step.cause)], grouped(created));
}

std::vector<Vec3> displacement_of(const TetMesh& mesh, const std::string& name) {
  const auto found = mesh.get_vertex_property<Vec3>(name);
  return {found->values().begin(), found->values().end()};
}

void require_displacement(const TetMesh& mesh, const std::string& name, const std::string& file) {
  try {
    if (mesh.get_vertex_property<Vec3>(name)) return;
  } catch (const InvalidInput&) {  // of another type
  }
  throw Failure(ExitCode::kUsage,
                fmt::format("{}: has no field {} of three numbers at its vertices (--displacement)", file,
                            in_quotes(name)));
}

ExitCode finish(const Ending& ending, const std::string& file, const std::vector<std::string>& notes,
                const CommonOptions& common, Json& report) {
  report["notes"] = notes;
  if (!common.quiet) print_notes(notes);
  if (ending.code != ExitCode::kDone) print_error(file + ": " + ending.why);
  return ending.code;
}

ExitCode move_one(const MoveLine& line, const CommonOptions& common, Json& report) {
  const io::WriteOptions write_options = require_writable_mesh(line.output, line.write, common);
  LoadedMesh loaded = load(line.input, common);
  TetMesh& mesh = loaded.mesh;
  require_displacement(mesh, line.displacement, line.input);
  const SignalGuard signals;
  RemesherOptions options = remesher_options(line, common, signals);
  options.fields = fields_of(mesh, line);
  Remesher remesher(mesh, options);
  const Stopwatch moving;
  const StepResult step = remesher.step(displacement_of(mesh, line.displacement));
  report["seconds"]["move"] = moving.seconds();
  report["step"] = step_json(step, mesh);
  std::vector<std::string> notes = std::move(loaded.notes);
  if (step.refused.empty() && !step.undone) {
    const io::MeshData data = io::disassemble(mesh, common.policy());
    for (std::string& note : notes_on_replacing(line.output)) notes.push_back(std::move(note));
    for (std::string& note : save(line.output, data, write_options)) notes.push_back(std::move(note));
    report["output"].update(contents(data));
  } else {
    notes.push_back("nothing was written");
  }
  if (common.prints_table()) print_step(line.output, step, mesh);
  return finish(ending_of(step, line), line.input, notes, common, report);
}

// --- a series ---

/// in_%04d.vtu → in_0012.vtu. Fails where there is not one %d or %0Nd.
std::string numbered(const std::string& pattern, int number) {
  const std::size_t at = pattern.find('%');
  const std::size_t d = pattern.find('d', at);
  const auto bad = [&] {
    return Failure(ExitCode::kUsage,
                   "--series " + in_quotes(pattern) + ": one %d or %04d is wanted for the number");
  };
  if (at == std::string::npos || d == std::string::npos || pattern.find('%', at + 1) != std::string::npos)
    throw bad();
  const std::string width = pattern.substr(at + 1, d - at - 1);
  if (width.size() > 3 || width.find_first_not_of("0123456789") != std::string::npos) throw bad();
  return fmt::format("{}{:0>{}}{}", pattern.substr(0, at), std::to_string(number),
                     width.empty() ? 1 : std::stoi(width), pattern.substr(d + 1));
}

std::vector<std::string> files_of(const std::string& pattern) {
  std::vector<std::string> files;
  int number = std::filesystem::exists(numbered(pattern, 0)) ? 0 : 1;
  for (; std::filesystem::exists(numbered(pattern, number)); ++number)
    files.push_back(numbered(pattern, number));
  if (files.size() < 2)
    throw Failure(
        ExitCode::kCannotRead,
        fmt::format("--series {}: at least two files are wanted, counted from 0 or 1; {}", in_quotes(pattern),
                    files.empty() ? numbered(pattern, 0) + " is missing" : "only " + files[0] + " is there"));
  return files;
}

/// The file of a step beside the collection.
std::string output_name(const std::filesystem::path& collection, std::size_t i) {
  return fmt::format("{}_{:04d}.vtu", collection.stem().string(), i);
}

/// Before anything is read: no file of the series is written over, by whatever name, and all outputs can be
/// written.
void require_outputs_apart(const MoveLine& line, const std::vector<std::string>& inputs,
                           const CommonOptions& common) {
  const std::filesystem::path collection = line.output;
  std::set<std::filesystem::path> known;
  for (const std::string& input : inputs) known.insert(std::filesystem::canonical(input));
  const auto require_new = [&](const std::filesystem::path& output) {
    if (known.contains(std::filesystem::weakly_canonical(output)))
      throw Failure(ExitCode::kUsage,
                    fmt::format("-o {}: {} of the series would be written over; choose another name",
                                in_quotes(collection.string()), output.string()));
  };
  require_new(collection);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string output = (collection.parent_path() / output_name(collection, i)).string();
    require_new(output);
    require_writable_mesh(output, line.write, common);
  }
}

/// The files of the command; those of a series are apart from each other, so as none of them counts as an
/// output that others would have to be held against.
std::vector<FileUse> uses_of(const MoveLine& line) {
  using Kind = FileUse::Kind;
  std::vector<FileUse> uses = {{Kind::kInput, "IN", line.input}, {Kind::kMesh, "-o", line.output}};
  if (line.series.empty()) return uses;
  std::vector<std::string> inputs;
  try {
    inputs = files_of(line.series);
  } catch (const Failure&) {
    return uses;  // the run says what is wrong
  }
  const std::filesystem::path collection = line.output;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    uses.push_back({Kind::kInput, "--series", inputs[i]});
    uses.push_back({Kind::kInput, "-o", (collection.parent_path() / output_name(collection, i)).string()});
  }
  return uses;
}

/// What is said of a series: what ended it, then inverted cells, then angles; of the first step that has it.
bool counts_before(ExitCode now, ExitCode so_far) {
  static constexpr std::array kOrder = {ExitCode::kCancelled, ExitCode::kLimit, ExitCode::kInvalidCells,
                                        ExitCode::kGoalMissed, ExitCode::kDone};
  return std::ranges::find(kOrder, now) < std::ranges::find(kOrder, so_far);
}

std::string step_name(std::size_t i) { return fmt::format("hfremesh: displacement {}", i); }

/// Gives the vertices a field for the displacement of each step: the difference of the files' points. They
/// are carried over repairs like any other, so that vertices that come later know where to go, too.
/// `copied`: vertices that the first mesh has behind those of its file, each by the one that it is a copy of.
void attach_motion(TetMesh& mesh, const std::vector<VertexHandle>& copied,
                   const std::vector<std::string>& files, const CommonOptions& common) {
  std::vector<Vec3> was(mesh.points().begin(), mesh.points().end());
  for (std::size_t i = 1; i < files.size(); ++i) {
    io::MeshData data = read_data(files[i], common);
    if (data.points.size() + copied.size() != was.size())
      throw Failure(ExitCode::kCannotRead,
                    fmt::format("{}: has {} vertices where {} has {}", files[i], data.points.size(), files[0],
                                was.size() - copied.size()));
    for (VertexHandle v : copied) data.points.push_back(data.points[v.idx()]);
    auto displacement = mesh.request_vertex_property<Vec3>(step_name(i));
    for (std::size_t v = 0; v < was.size(); ++v) displacement[VertexHandle(v)] = data.points[v] - was[v];
    was = data.points;
  }
}

/// A collection that ParaView opens as an animation.
void write_collection(const std::string& path, const std::vector<std::string>& files) {
  io::OutputFile file(path);
  file.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n");
  for (std::size_t i = 0; i < files.size(); ++i)
    file.text(
        fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", i, io::xml_escaped(files[i])));
  file.text("  </Collection>\n</VTKFile>\n");
  file.commit();
}

ExitCode move_series(const MoveLine& line, const CommonOptions& common, Json& report) {
  const std::filesystem::path collection = line.output;
  if (collection.extension() != ".pvd")
    throw Failure(ExitCode::kUsage,
                  "-o " + in_quotes(line.output) + ": a series is written as .pvd, with a .vtu a step");
  require_writable(line.output);
  const std::vector<std::string> files = files_of(line.series);
  require_outputs_apart(line, files, common);
  LoadedMesh loaded = load(files[0], common);
  TetMesh& mesh = loaded.mesh;
  std::vector<FieldTransfer> fields = fields_of(mesh, line);
  attach_motion(mesh, loaded.report.copied, files, common);
  const SignalGuard signals;  // from here on there is something to save
  RemesherOptions options = remesher_options(line, common, signals);
  options.fields = std::move(fields);
  for (std::size_t i = 1; i < files.size(); ++i) options.fields.push_back({.name = step_name(i)});
  std::vector<std::string> notes = std::move(loaded.notes), written;
  const auto write_step = [&](std::size_t i) {
    TetMesh shown = mesh;
    for (std::size_t k = 1; k < files.size(); ++k) shown.properties().vertices.remove(step_name(k));
    const std::string name = output_name(collection, i);
    const std::string path = (collection.parent_path() / name).string();
    for (std::string& note : save(path, io::disassemble(shown, common.policy()), line.write))
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
    written.push_back(name);
    write_collection(line.output, written);
  };
  Remesher remesher(mesh, options);
  write_step(0);
  report["steps"] = Json::array();
  const Stopwatch moving;
  Ending ending;
  for (std::size_t i = 1; i < files.size(); ++i) {
    if (signals.cancelled()) {  // also where no step repairs, which would ask
      ending = {ExitCode::kCancelled, fmt::format("cancelled before step {}", i)};
      break;
    }
    const StepResult step = remesher.step(displacement_of(mesh, step_name(i)));
    report["steps"].push_back(step_json(step, mesh));
    if (common.prints_table()) print_step(files[i], step, mesh);
    const Ending now = ending_of(step, line);
    if (counts_before(now.code, ending.code)) ending = {now.code, fmt::format("step {}: {}", i, now.why)};
    // The next file begins where this step was to end.
    if (!step.refused.empty() || step.undone || step.stop == Stop::kCancelled || step.fraction < 1) break;
    write_step(i);
  }
  report["seconds"]["move"] = moving.seconds();
  return finish(ending, line.series, notes, common, report);
}

ExitCode run(const MoveLine& line, const CommonOptions& common, Json& report) {
  if (line.trigger > line.goal)
    throw Failure(ExitCode::kUsage, "--trigger must not be above --min-dihedral, or every step would repair");
  report["output"]["file"] = line.output;
  if (!line.series.empty()) {
    if (!line.input.empty() || !line.displacement.empty())
      throw Failure(ExitCode::kUsage, "--series names all files: neither IN nor --displacement goes with it");
    report["input"]["file"] = line.series;
    return move_series(line, common, report);
  }
  if (line.input.empty() || line.displacement.empty())
    throw Failure(ExitCode::kUsage,
                  "IN and --displacement FIELD are required, or --series; try 'hfremesh move --help'");
  report["input"]["file"] = line.input;
  return move_one(line, common, report);
}

void add_motion_options(Command command, MoveLine& line) {
  command.group("Motion");
  command.option("--displacement", line.displacement, "Field of the vertices by which they are moved")
      .type_name("FIELD");
  command
      .option("--series", line.series,
              "All steps of a motion: files of one connectivity, such as in_%04d.vtu; -o is a .pvd then")
      .type_name("PATTERN");
  command
      .option("--on-inversion", line.on_inversion,
              "A move that inverts cells: repair (after it), substeps (in safe parts), refuse")
      .type_name("WHAT")
      .shows_default()
      .one_of({"repair", "substeps", "refuse"});
  command
      .option("--motion", line.motion,
              "given: of every vertex; laplace, elastic: of the boundary, which the others follow")
      .type_name("WHAT")
      .shows_default()
      .one_of({"given", "laplace", "elastic"});
}

void add_repair_options(Command command, MoveLine& line) {
  command.group("Repair");
  command.option("--min-dihedral", line.goal, "Goal of a repair")
      .type_name("DEG")
      .shows_default()
      .check(real_number(0, 70.5, false));
  command.option("--trigger", line.trigger, "Repair once an angle is below this")
      .type_name("DEG")
      .shows_default()
      .check(real_number(0, 70.5));
  command
      .option("--trigger-field", line.trigger_field,
              "Repair, too, where this field of cells is not 0; it is carried over like the others")
      .type_name("FIELD");
  command.option("--surface", line.surface, "What a repair may do to the surface: frozen, flat, free")
      .type_name("MODE")
      .shows_default()
      .one_of({"frozen", "flat", "free"});
  command.option("--time-limit", line.time_limit, "Seconds of each repair")
      .type_name("S")
      .shows_default("none")
      .check(positive_number());
}

}  // namespace

Subcommand add_move(Command program, CommonOptions& common) {
  const auto line = std::make_shared<MoveLine>();
  Command command = program.subcommand("move", "Move a mesh, repair it, and carry its fields over");
  command.example("hfremesh move in.vtu --displacement u -o out.vtu", "one step; fields are carried over");
  command.example(
      "hfremesh move in.vtu --displacement u -o out.vtu --motion laplace --trigger 15 --min-dihedral 20",
      "the inside follows the boundary; repaired to 20 degrees once below 15");
  command.group("Mesh");
  command.option("IN", line->input, "Mesh to read").type_name("FILE").transform(stream_name());
  command.option("-o,--output", line->output, "Mesh to write")
      .required()
      .type_name("FILE")
      .transform(stream_name());
  add_motion_options(command, *line);
  add_repair_options(command, *line);
  command.group("Fields");
  command
      .option("--transfer", line->transfer,
              "How a field gets over a repair: NAME:linear or NAME:quadratic (of vertices), NAME:inherit, "
              "NAME:conserve or NAME:conserve:DENSITY (of cells). Others: linear, and inherited")
      .type_name("NAME:HOW")
      .one_a_use();
  add_format_options(command, common, true, true);
  add_split_option(command, common);
  add_write_options(command, line->write);
  add_common_options(command, common);
  return {command, [line] { return uses_of(*line); },
          [line, &common](Json& report) { return run(*line, common, report); }};
}

}  // namespace hfr::app
