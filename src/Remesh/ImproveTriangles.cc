// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/ImproveTriangles.hh"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <span>
#include <string>

#include "HalfFace/Errors.hh"
#include "Remesh/Coordinates.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Surfaces.hh"
#include "Surface/SurfaceMesh.hh"
#include "Surface/TriangleSweep.hh"

namespace hfr {
namespace {

class TriangleRun {
 public:
  TriangleRun(TriangleMesh& mesh, const TriangleOptions& options, TriangleResult& result)
      : options_(options),
        result_(result),
        start_(std::chrono::steady_clock::now()),
        surface_(mesh, options.surface),
        sweep_(surface_) {}

  void run() {
    if (options_.min_angle) {
      polish(*options_.min_angle);
    } else {
      bulk();
      for (double target : effort_.targets) {
        if (stopped()) break;
        sweep_.focus(dihedral_decision(target));
        const auto n = static_cast<double>(sweep_.n_below());
        if (n > effort_.largest_share * static_cast<double>(result_.before.triangles)) break;
        if (n > 0) polish(target);
      }
    }
    restore_volume();
  }
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  void write(TriangleMesh& mesh);
  const SurfaceMesh& surface() const { return surface_; }

 private:
  bool stopped() {
    if (result_.stop != Stop::kNoProgress) return true;
    if (options_.cancel && options_.cancel())
      result_.stop = Stop::kCancelled;
    else if (seconds() > options_.time_limit)
      result_.stop = Stop::kTimeLimit;
    return result_.stop != Stop::kNoProgress;
  }
  std::size_t pass(const char* stage, const char* op, int iteration, std::size_t (TriangleSweep::*work)()) {
    return stopped() ? 0 : pass_in_any_case(stage, op, iteration, work);
  }
  std::size_t pass_in_any_case(const char* stage, const char* op, int iteration,
                               std::size_t (TriangleSweep::*work)()) {
    PassReport report;
    const double before = seconds();
    report.stage = stage;
    report.op = op;
    report.iteration = iteration;
    report.rounds = 1;
    report.winners = report.candidates = (sweep_.*work)();
    report.worst = sweep_.worst();
    report.seconds = report.seconds_evaluate = seconds() - before;
    result_.passes.push_back(report);
    return report.winners;
  }
  void bulk() {
    sweep_.focus(std::numeric_limits<double>::infinity());
    for (int i = 1; i <= effort_.bulk_iterations && !stopped(); ++i) {
      const std::size_t n = pass("bulk", "surface swap", i, &TriangleSweep::swap) +
                            pass("bulk", "surface smooth", i, &TriangleSweep::smooth);
      if (static_cast<double>(n) < effort_.enough * static_cast<double>(result_.before.triangles)) break;
    }
  }
  void polish(double degrees) {
    sweep_.focus(dihedral_decision(degrees));
    std::size_t n_poor = sweep_.n_below();
    int idle = 0;
    for (int i = 1; i <= effort_.iterations && n_poor > 0 && !stopped(); ++i) {
      std::size_t n = pass("polish", "surface swap", i, &TriangleSweep::swap);
      n += pass("polish", "surface node", i, &TriangleSweep::collapse);
      n += pass("polish", "surface smooth", i, &TriangleSweep::smooth);
      std::size_t now = sweep_.n_below();
      idle = now < n_poor ? 0 : idle + 1;
      if (now > 0 && (n == 0 || idle >= effort_.idle)) {
        if (pass("polish", "surface split", i, &TriangleSweep::split) == 0) break;
        now = sweep_.n_below();
        if (idle > 2 * effort_.idle) break;
      }
      n_poor = now;
    }
  }
  /// Also of a run that was stopped.
  void restore_volume() {
    if (surface_.options().mode != SurfaceMode::kFree) return;
    sweep_.focus(effort_.volume_focus * sweep_.worst());
    for (int i = 1; i <= effort_.volume.passes && std::abs(surface_.volume_gain()) > effort_.volume.enough;
         ++i)
      if (pass_in_any_case("volume", "surface volume", i, &TriangleSweep::offset) == 0) break;
  }

  const TriangleOptions& options_;
  TriangleResult& result_;
  const TriangleEffort effort_;
  std::chrono::steady_clock::time_point start_;
  SurfaceMesh surface_;
  TriangleSweep sweep_;
};

void TriangleRun::write(TriangleMesh& mesh) {
  std::vector<std::uint8_t> had(sweep_.points().size(), 0), has(had);
  had.resize(std::max(had.size(), mesh.points.size()));
  has.resize(had.size());
  for (const auto& t : mesh.triangles)
    for (VertexHandle v : t) had[v.idx()] = 1;
  mesh.triangles.clear();
  const bool labelled = !mesh.patches.empty();
  mesh.patches.clear();
  for (std::size_t f = 0; f < surface_.n_faces(); ++f) {
    if (surface_.is_deleted(f)) continue;
    mesh.triangles.push_back(surface_.face_vertices(f));
    if (labelled) mesh.patches.push_back(surface_.patch(f));
    for (VertexHandle v : mesh.triangles.back()) has[v.idx()] = 1;
  }
  const std::size_t n_old = mesh.points.size();
  std::vector<VertexHandle> number(had.size());
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < had.size(); ++v) {
    const bool stays = has[v] || (v < n_old && !had[v]);  // what no triangle used is none of ours
    if (!stays) continue;
    number[v] = VertexHandle(points.size());
    points.push_back(has[v] ? sweep_.points()[v] : mesh.points[v]);
  }
  mesh.points = std::move(points);
  for (auto& t : mesh.triangles)
    for (VertexHandle& v : t) v = number[v.idx()];
  number.resize(n_old);
  result_.vertex_map = std::move(number);
}

/// One that is misspelt would hold nothing, and nobody would know.
void require_fixed_parts(const TriangleMesh& mesh, const SurfaceOptions& options) {
  const auto text = [](const char* kind, std::span<const VertexHandle> vertices) {
    std::string name = std::string("fix ") + kind;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      name += (i == 0 ? ':' : '-') + std::to_string(vertices[i].idx());
    return name;
  };
  const auto is_there = [&](VertexHandle v) { return v.is_valid() && v.idx() < mesh.points.size(); };
  for (VertexHandle v : options.fixed_vertices)
    HFR_REQUIRE(is_there(v), text("vertex", {&v, 1}) + ": there are " + std::to_string(mesh.points.size()) +
                                 " points, counted from 0");
  std::set<std::array<VertexHandle, 2>> edges;
  std::set<std::array<VertexHandle, 3>> faces;
  for (const auto& t : mesh.triangles) {
    if (!options.fixed_faces.empty()) faces.insert(AnyOrder::key(t));
    for (std::size_t k = 0; k < 3 && !options.fixed_edges.empty(); ++k)
      edges.insert(AnyOrder::key(std::array{t[k], t[(k + 1) % 3]}));
  }
  for (const auto& edge : options.fixed_edges)
    HFR_REQUIRE(edges.contains(AnyOrder::key(edge)), text("edge", edge) + ": there is no such edge");
  for (const auto& face : options.fixed_faces)
    HFR_REQUIRE(faces.contains(AnyOrder::key(face)), text("face", face) + ": there is no such triangle");
  for (int patch : options.fixed_patches)
    HFR_REQUIRE(std::ranges::find(mesh.patches, patch) != mesh.patches.end(),
                "fix patch:" + std::to_string(patch) + ": no triangle has this label");
}

void validate(const TriangleMesh& mesh, const TriangleOptions& options) {
  HFR_REQUIRE(options.surface.mode != SurfaceMode::kFrozen,
              "a surface without cells cannot be improved while it is frozen: use flat or free");
  HFR_REQUIRE(!options.min_angle || (*options.min_angle > 0 && *options.min_angle < 60),
              "the smallest angle asked for must lie between 0 and 60 degrees, not " +
                  std::to_string(options.min_angle.value_or(0)));
  HFR_REQUIRE(options.time_limit > 0, "the time limit must be positive");
  HFR_REQUIRE(mesh.patches.empty() || mesh.patches.size() == mesh.triangles.size(),
              "there must be a label for each triangle, or none at all");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const bool known = std::all_of(
        t.begin(), t.end(), [&](VertexHandle v) { return v.is_valid() && v.idx() < mesh.points.size(); });
    HFR_REQUIRE(known, "triangle " + std::to_string(i) + " names a vertex that is not there");
    HFR_REQUIRE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0],
                "triangle " + std::to_string(i) + " names a vertex twice");
  }
  require_fixed_parts(mesh, options.surface);
}

}  // namespace

TriangleResult improve_triangles(TriangleMesh& mesh, const TriangleOptions& options) {
  validate(mesh, options);
  require_sound_coordinates(mesh);
  TriangleResult result;
  result.before = statistics(mesh);
  std::vector<Triangle> before;
  for (const auto& t : mesh.triangles) before.push_back(corners(mesh, t));
  const auto meets_goal = [&](const TriangleStatistics& s) {
    return s.flat == 0 && (!options.min_angle || s.min_angle.min >= *options.min_angle);
  };
  TriangleRun run(mesh, options, result);
  if (!options.min_angle || !meets_goal(result.before)) run.run();
  run.write(mesh);
  result.seconds = run.seconds();
  result.changed = std::any_of(result.passes.begin(), result.passes.end(),
                               [](const PassReport& pass) { return pass.winners > 0; });
  result.after = result.changed ? statistics(mesh) : result.before;
  result.goal_reached = meets_goal(result.after);
  if (result.stop == Stop::kNoProgress && options.min_angle && result.goal_reached) result.stop = Stop::kGoal;
  std::vector<Triangle> after;
  for (const auto& t : mesh.triangles) after.push_back(corners(mesh, t));
  result.surface.mode = run.surface().options().mode;
  result.surface.bound = run.surface().hausdorff();
  result.surface.feature_edges = run.surface().n_feature_edges();
  measure_surfaces(before, after, result.before.volume, result.after.volume, options.policy, result.surface);
  return result;
}

}  // namespace hfr
