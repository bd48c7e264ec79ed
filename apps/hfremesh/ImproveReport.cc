// SPDX-License-Identifier: BSD-3-Clause
#include "ImproveReport.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "Console.hh"
#include "Report.hh"

namespace hfr::app {
namespace {

/// With a length of two digits that is no smaller.
std::string round_up_option(std::string_view name, double length) {
  const double unit = std::pow(10.0, std::floor(std::log10(length)) - 1);
  return fmt::format("{} {:.2g}", name, std::ceil(length / unit) * unit);
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

}  // namespace

ExitCode exit_code_of(const Result& result) {
  if (result.stop == Stop::kCancelled) return ExitCode::kCancelled;
  if (result.stop == Stop::kDeviceLost) return ExitCode::kDevice;
  if (result.goal_reached) return ExitCode::kDone;
  if (result.stop == Stop::kTimeLimit) return ExitCode::kLimit;
  return result.invalid_cells.empty() ? ExitCode::kGoalMissed : ExitCode::kInvalidCells;
}

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

/// What no mesh with this surface can have, where that is proven and says something.
void print_ceiling(const Result& result) {
  const EdgeWedge& ceiling = result.after.angle_ceiling;
  if (result.surface.mode != SurfaceMode::kFrozen || !ceiling.cell.is_valid()) return;
  // Where no mesh is without an invalid cell, that is said already.
  if (!result.unfillable_faces.empty()) return;
  constexpr double kRegular = 70.528;  // degrees; no tetrahedron has more
  if (ceiling.degrees >= kRegular) return;
  print("smallest angle: at most {:.2f} degrees with this surface (proven), {:.2f} reached\n",
        ceiling.degrees, result.after.min_dihedral.min);
}

void print_result(const Result& result, const Seconds& seconds, bool dry_run, const CommonOptions& common) {
  if (common.verbose) print_passes(result.passes);
  print_statistics({{"before", &result.before}, {"after", &result.after}});
  print_ceiling(result);
  print_limits(result);
  print("{}; seconds: read {:.2f}, build {:.2f}, improve {:.2f}, statistics {:.2f}, write {:.2f}\n",
        result.changed ? "changed" : "unchanged", seconds.read, seconds.build, seconds.improve,
        seconds.statistics, seconds.write);
  if (result.surface.mode != SurfaceMode::kFrozen) print_surface(result.surface);
  if (dry_run) print("dry run: nothing was written\n");
}

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

}  // namespace hfr::app
