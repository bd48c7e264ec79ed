// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Improve.hh"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "HalfFace/Errors.hh"
#include "HalfFace/Reorder.hh"
#include "Quality/FoldedFaces.hh"
#include "Quality/Metrics.hh"
#include "Quality/UnfillableFaces.hh"
#include "Remesh/Coordinates.hh"
#include "Remesh/Explain.hh"
#include "Remesh/FixedParts.hh"
#include "Remesh/MapRecorder.hh"
#include "Remesh/Run.hh"
#include "Remesh/RunMemory.hh"
#include "Remesh/StuckCells.hh"
#include "Remesh/SurfaceRun.hh"
#include "Remesh/Survey.hh"
#include "Remesh/WholeRun.hh"

namespace hfr {
namespace {

/// What a run is made of, and leaves for the report.
struct Parts {
  const ImproveOptions& options;
  const Strategy& strategy;
  RunControl& control;
  Findings& findings;
  DeviceSession& device;
  Checkpoint& checkpoint;
  RunMemory& memory;
};

/// True when every cell is known to meet the goal. `order`: where each vertex and cell went, if the cells
/// were reordered. `has_begun`: set before the first operator.
bool run(TetMesh& mesh, const Parts& parts, GarbageMap& order, bool& has_begun,
         SurfaceReport& surface_report) {
  const auto& [options, strategy, control, findings, device, checkpoint, memory] = parts;
  const par::Policy policy = strategy.pass.policy;
  const bool valid = checkpoint.input().is_valid();
  // Most of a run over everything is walking from cell to cell; a goal run touches too little to pay for it.
  Workspace& work = memory.work;
  if (!strategy.goal && is_scattered(mesh, policy)) {
    order = reorder(mesh, {.curve = SpaceCurve::kMorton, .vertices = false, .policy = policy});
    work.follow_order(order.cells);
  }
  const bool knows_stars = std::exchange(memory.knows_stars, false);
  Run run = {mesh, work, strategy, control, findings, device, nullptr, &checkpoint, strategy.bounds};
  if (!valid) run.keep(valid);
  std::vector<PassReport> unfolding;
  const SurfaceRun surface(mesh, options, !valid, unfolding,
                           [&run_control = control] { return run_control.stopped(); });
  for (PassReport& pass : unfolding) control.add(std::move(pass));
  if (surface.get() && !valid) work.forget_qualities();  // it may have been unfolded
  if (!knows_stars) work.find_stars(mesh, policy);
  work.attach_again(mesh, policy);
  if (!work.has_qualities_of<MinSine2>()) work.set_qualities(mesh, MinSine2{}, policy);
  if (!memory.is_folded || surface.get()) memory.is_folded = !folded_faces(mesh, policy).empty();
  findings.is_folded = *memory.is_folded;
  findings.may_cover_twice = !valid || !std::exchange(memory.covers_once, false);
  run.surface = surface.get();
  run.ranks = memory.ranks;
  has_begun = true;
  const Ending ending = run_to_the_end(run);
  memory.knows_stars = ending.stays;
  memory.covers_once = ending.stays && !findings.may_cover_twice && !findings.is_folded;
  if (surface.get()) {
    memory.is_folded.reset();
    memory.covers_once = false;
  }
  surface_report = surface.report(mesh);
  return ending.meets;
}

/// Gives the mesh handles without gaps, in the old order where nothing has changed. Returns where each vertex
/// and cell went; nothing where they stay.
GarbageMap tidy(TetMesh& mesh, const ImproveOptions& options, bool changed, const GarbageMap& order) {
  if (changed) return mesh.collect_garbage({.policy = options.policy});
  GarbageMap map;
  if (order.cells.empty()) return map;
  map.cells.resize(mesh.n_cells());
  std::size_t n = 0;
  for (CellHandle c : order.cells)
    if (c.is_valid()) map.cells[c.idx()] = CellHandle(n++);
  restore_cell_order(mesh, order.cells, options.policy);
  return map;
}

/// Fills in what is said of a mesh that is not known to meet the goal.
void look_for_faults(const TetMesh& mesh, const Survey& found, const KnownValues& known, par::Policy policy,
                     Result& result) {
  if (found.n_invalid == 0) return;
  result.invalid_cells = invalid_cells(mesh, policy, known);
  result.folded_faces = folded_faces(mesh, policy);
  result.unfillable_faces = unfillable_faces(mesh, result.invalid_cells, result.folded_faces, policy);
}

/// Of the mesh as it ended, beside what it was.
void add_statistics(const TetMesh& mesh, const ImproveOptions& options, const Strategy& strategy,
                    const Findings& findings, const KnownValues& known, Result& result) {
  result.after = result.changed ? statistics(mesh, options.policy) : result.before;
  explain(mesh, options, strategy, findings.max_cells_met, known, result);
  for (const std::uint32_t size : star_sizes(mesh, options.policy))
    result.n_large_stars += size > Star::kCapacity ? 1 : 0;
}

/// Of a mesh without deleted cells and vertices, which has what the options name.
Result improve_dense(TetMesh& mesh, const ImproveOptions& options, RunMemory& memory) {
  Result result;
  if (options.statistics) result.before = statistics(mesh, options.policy);
  RunControl control(options.time_limit, options.cancel, options.progress);
  const double goal = options.min_dihedral ? dihedral_decision(*options.min_dihedral) : 0.0;
  const auto meets_goal = [&](const Survey& found) { return found.n_invalid == 0 && found.worst >= goal; };
  Workspace& work = memory.work;
  work.begin();
  if (!memory.found) {
    work.set_qualities(mesh, MinSine2{}, options.policy);
    memory.found = survey(mesh, options.policy, known_values(work));
  }
  Survey found = *std::exchange(memory.found, std::nullopt);
  const Strategy strategy = resolve(options, found, mesh.n_logical_cells());
  Checkpoint checkpoint(mesh, found, options.policy, known_values(work));
  checkpoint.may_trust(strategy.course == Course::kGoal);  // which has no copy of a mesh that comes in sound
  Findings findings;
  DeviceSession device;
  const bool nothing_to_do = strategy.course == Course::kGoal && meets_goal(found);
  if (!nothing_to_do) {
    const double before = control.seconds();
    device = DeviceSession(options.device, options.device_tuning, mesh);
    if (device.mesh()) result.device = device.mesh()->info().name;
    result.seconds_device = control.seconds() - before;
  }
  std::optional<MapRecorder> recorder;
  if (options.maps) recorder.emplace(mesh, std::exchange(memory.before, nullptr));
  GarbageMap order;
  bool known_to_meet = nothing_to_do;
  FixedParts fixed(mesh, options.surface);
  bool has_begun = false;
  try {
    if (!nothing_to_do)
      known_to_meet = run(mesh, {options, strategy, control, findings, device, checkpoint, memory}, order,
                          has_begun, result.surface);
  } catch (...) {  // of a callback, most likely
    checkpoint.settle_after_failure(mesh);
    const bool changed = has_begun && !checkpoint.is_input();
    fixed.release(mesh, tidy(mesh, options, changed, order).vertices);
    throw;
  }
  result.passes = std::move(control.passes());
  result.device_note = device.note();
  if (device.mesh()) result.kernel_times = device.mesh()->profile();
  result.changed = control.n_changes() > 0;
  const GarbageMap garbage = tidy(mesh, options, result.changed, order);
  fixed.release(mesh, garbage.vertices);
  if (!result.changed && !order.cells.empty()) work.forget_qualities();
  if (memory.knows_stars) work.follow(garbage);
  if (recorder) result.maps = recorder->maps(order, garbage, options.policy);
  if (!known_to_meet) {
    if (result.changed) found = survey(mesh, options.policy, known_values(work));
    look_for_faults(mesh, found, known_values(work), options.policy, result);
  }
  result.goal_reached = known_to_meet || meets_goal(found);
  result.stop = control.reason_to_end(options, result.goal_reached);
  result.seconds = control.seconds();
  if (options.statistics) add_statistics(mesh, options, strategy, findings, known_values(work), result);
  return result;
}

}  // namespace

Result improve(TetMesh& mesh, const ImproveOptions& options) {
  RunMemory memory;
  return improve(mesh, options, memory);
}

Result improve(TetMesh& mesh, const ImproveOptions& options, RunMemory& memory) {
  validate(options);
  require_fixed_parts(mesh, options.surface);
  require_sound_coordinates(mesh, options.policy);
  if (options.compat != Compat::kNone && options.surface.mode != SurfaceMode::kFrozen) {
    ImproveOptions frozen = options;  // a published pipeline, which moves no surface
    frozen.surface.mode = SurfaceMode::kFrozen;
    return improve(mesh, frozen, memory);
  }
  if (!mesh.needs_garbage_collection()) return improve_dense(mesh, options, memory);
  const GarbageMap garbage = mesh.collect_garbage({.policy = options.policy});
  ImproveOptions renamed = options;
  rename_fixed(renamed.surface, garbage.vertices);
  Result result = improve_dense(mesh, renamed, memory);
  if (options.maps) result.maps = with_old_handles(garbage, result.maps);
  return result;
}

}  // namespace hfr
