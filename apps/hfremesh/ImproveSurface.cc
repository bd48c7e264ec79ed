// SPDX-License-Identifier: BSD-3-Clause
// hfremesh IN -o OUT where IN has triangles and no tetrahedra.
#include "ImproveSurface.hh"

#include <fmt/format.h>

#include <algorithm>

#include "Console.hh"
#include "Files.hh"
#include "Json.hh"
#include "Labels.hh"
#include "Paths.hh"
#include "Report.hh"
#include "Signals.hh"
#include "hfremesh/Remesh/ImproveTriangles.hh"

namespace hfr::app {
namespace {

TriangleMesh triangles_of(const io::MeshData& data, std::vector<std::string>& notes) {
  TriangleMesh mesh;
  mesh.points = data.points;
  const bool labelled = std::any_of(data.triangle_labels.begin(), data.triangle_labels.end(),
                                    [](int label) { return label != 0; });
  std::size_t n_dropped = 0;
  for (std::size_t i = 0; i < data.triangles.size(); ++i) {
    const auto& t = data.triangles[i];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      ++n_dropped;
      continue;
    }
    mesh.triangles.push_back({VertexHandle(t[0]), VertexHandle(t[1]), VertexHandle(t[2])});
    if (labelled) mesh.patches.push_back(data.triangle_labels[i]);
  }
  if (n_dropped > 0) notes.push_back(fmt::format("{} triangles with two equal corners dropped", n_dropped));
  return mesh;
}

/// What the file holds to stay: its edges, its fixed and its labelled vertices.
void add_constraints(const io::MeshData& data, SurfaceOptions& surface) {
  for (const auto& e : data.edges) surface.fixed_edges.push_back({VertexHandle(e[0]), VertexHandle(e[1])});
  for (Index v : data.fixed_vertices) surface.fixed_vertices.push_back(VertexHandle(v));
  for (std::size_t v = 0; v < data.vertex_labels.size(); ++v)
    if (data.vertex_labels[v] != 0) surface.fixed_vertices.push_back(VertexHandle(v));
}

/// The result with everything of the input that still has its place.
io::MeshData data_of(const TriangleMesh& mesh, const TriangleResult& result, io::MeshData was,
                     std::vector<std::string>& notes) {
  const auto now = [&](Index v) { return result.vertex_map[v].idx(); };
  io::MeshData data;
  data.points = mesh.points;
  data.names = std::move(was.names);
  for (const auto& t : mesh.triangles) data.triangles.push_back({t[0].idx(), t[1].idx(), t[2].idx()});
  data.triangle_labels = mesh.patches;
  if (data.triangle_labels.empty()) data.triangle_labels.resize(data.triangles.size());
  for (const auto& e : was.edges) data.edges.push_back({now(e[0]), now(e[1])});
  data.edge_labels = std::move(was.edge_labels);
  for (Index v : was.fixed_vertices) data.fixed_vertices.push_back(now(v));
  if (!was.vertex_labels.empty()) {
    data.vertex_labels.resize(data.points.size(), 0);
    for (std::size_t v = 0; v < was.vertex_labels.size(); ++v)
      if (was.vertex_labels[v] != 0) data.vertex_labels[now(static_cast<Index>(v))] = was.vertex_labels[v];
  }
  if (!was.point_fields.empty() || !was.cell_fields.empty())
    notes.emplace_back("fields are not carried over to the new surface");
  return data;
}

Json to_json(const TriangleStatistics& s) {
  Json json;
  json["vertices"] = s.vertices;
  json["triangles"] = s.triangles;
  json["open_edges"] = s.open_edges;
  json["non_manifold_edges"] = s.non_manifold_edges;
  json["flat"] = s.flat;
  json["min_angle"] = distribution_json(s.min_angle);
  json["max_angle"] = s.max_angle;
  json["area"] = s.area;
  json["volume"] = s.volume;
  return json;
}

void print_table(const TriangleResult& result) {
  const auto row = [&](const char* name, auto&& text) {
    print("{:<16}  {:>12}  {:>12}\n", name, text(result.before), text(result.after));
  };
  using S = TriangleStatistics;
  print("{:<16}  {:>12}  {:>12}\n", "", "before", "after");
  row("triangles", [](const S& s) { return grouped(s.triangles); });
  row("vertices", [](const S& s) { return grouped(s.vertices); });
  row("open edges", [](const S& s) { return grouped(s.open_edges); });
  row("non-manifold", [](const S& s) { return grouped(s.non_manifold_edges); });
  row("angle min", [](const S& s) { return fmt::format("{:.2f}", s.min_angle.min); });
  row("  p1", [](const S& s) { return fmt::format("{:.2f}", s.min_angle.percentiles[1]); });
  row("  p5", [](const S& s) { return fmt::format("{:.2f}", s.min_angle.percentiles[2]); });
  row("  median", [](const S& s) { return fmt::format("{:.2f}", s.min_angle.percentiles[4]); });
  row("angle max", [](const S& s) { return fmt::format("{:.2f}", s.max_angle); });
  row("area", [](const S& s) { return fmt::format("{:.8g}", s.area); });
  row("volume", [](const S& s) { return fmt::format("{:.8g}", s.volume); });
}

ExitCode exit_code_of(const TriangleResult& result) {
  if (result.stop == Stop::kCancelled) return ExitCode::kCancelled;
  if (result.goal_reached) return ExitCode::kDone;
  return result.stop == Stop::kTimeLimit ? ExitCode::kLimit : ExitCode::kGoalMissed;
}

std::string shortfall(const TriangleResult& result, double min_angle) {
  if (result.stop == Stop::kCancelled) return "cancelled; the surface is the best so far";
  if (result.stop == Stop::kTimeLimit) return "the time limit was met; the surface is the best so far";
  if (result.after.flat > 0) return fmt::format("{} triangles without area remain", result.after.flat);
  return fmt::format("the goal of {} degrees was not reached for every triangle", min_angle);
}

TriangleOptions options_of(const SurfaceCommand& command, const io::MeshData& data,
                           const SignalGuard& signals, const CommonOptions& common) {
  if (command.mode == "frozen")
    throw Failure(ExitCode::kUsage, command.input +
                                        " has no tetrahedra, and with --surface frozen nothing "
                                        "may change: use flat or free");
  if (!command.min_dihedral.empty())
    throw Failure(ExitCode::kUsage, command.input +
                                        " has no tetrahedra, whose angles --min-dihedral is about: "
                                        "use --min-angle");
  TriangleOptions options;
  options.surface = command.surface;
  options.surface.mode = command.mode == "flat" ? SurfaceMode::kFlat : SurfaceMode::kFree;
  require_fixed(options.surface, data);
  add_constraints(data, options.surface);
  if (command.min_angle > 0) options.min_angle = command.min_angle;
  if (command.time_limit > 0) options.time_limit = command.time_limit;
  options.policy = common.policy();
  options.cancel = [&signals] { return signals.cancelled(); };
  return options;
}

}  // namespace

ExitCode improve_surface(const SurfaceCommand& command, io::MeshData data, const CommonOptions& common,
                         Json& report) {
  const SignalGuard signals;
  const TriangleOptions options = options_of(command, data, signals, common);
  std::vector<std::string> notes = std::move(data.notes);
  report["options"]["surface"] = options.surface.mode == SurfaceMode::kFlat ? "flat" : "free";
  report["options"]["min_angle"] = options.min_angle ? Json(*options.min_angle) : Json();

  TriangleMesh mesh = triangles_of(data, notes);
  const Stopwatch improving;
  const TriangleResult result = improve_triangles(mesh, options);
  const double statistics = improving.seconds() - result.seconds;

  const Stopwatch writing;
  data = data_of(mesh, result, std::move(data), notes);
  if (!command.dry_run) {
    for (std::string& note : notes_on_replacing(command.output)) notes.push_back(std::move(note));
    for (std::string& note : save(command.output, data, command.write)) notes.push_back(std::move(note));
  }
  report["output"].update(contents(data));
  report["seconds"] = {{"read", command.seconds_read},
                       {"improve", result.seconds},
                       {"statistics", statistics},
                       {"write", writing.seconds()}};
  report["result"] = {
      {"changed", result.changed}, {"goal_reached", result.goal_reached}, {"stop", stop_name(result.stop)}};
  report["before"] = to_json(result.before);
  report["after"] = to_json(result.after);
  report["surface"] = surface_json(result.surface);
  report["passes"] = Json::array();
  for (const PassReport& pass : result.passes) report["passes"].push_back(to_json(pass));
  report["notes"] = notes;
  if (!common.quiet) print_notes(notes);
  if (common.prints_table()) {
    if (common.verbose) print_passes(result.passes);
    print_table(result);
    print("{}; seconds: read {:.2f}, improve {:.2f}, statistics {:.2f}, write {:.2f}\n",
          result.changed ? "changed" : "unchanged", command.seconds_read, result.seconds, statistics,
          writing.seconds());
    print_surface(result.surface);
    if (command.dry_run) print("dry run: nothing was written\n");
  }
  const ExitCode code = exit_code_of(result);
  if (code != ExitCode::kDone) print_error(command.input + ": " + shortfall(result, command.min_angle));
  return code;
}

}  // namespace hfr::app
