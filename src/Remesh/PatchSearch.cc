// SPDX-License-Identifier: BSD-3-Clause
// Insertion "followed by smoothing and topological improvement", kept or rolled back as one step (Klingner &
// Shewchuk 2007): here on a copy of the surroundings of each of the last few cells.
#include <algorithm>
#include <optional>

#include "Operators/Metrics.hh"
#include "Operators/Replace.hh"
#include "Operators/VertexInsertion.hh"
#include "Remesh/Patch.hh"
#include "Remesh/Pipeline.hh"

namespace hfr {
namespace {

constexpr double kLoss = 0.02;       // of sin² of the worst cell, that a new vertex may leave at first
constexpr double kAhead = 1.05;      // times the goal, which is worked for
constexpr double kLargestGoal = 60;  // degrees
constexpr double kPatchNanoseconds = 1e7;

struct Outcome {
  std::optional<TetMesh> mesh;
  double worst = 0;
};

/// The best of several tries at the patch: none unless its worst cell gets better.
Outcome search(const Patch& patch, const ImproveOptions& options, double seconds, double goal, int n_sites) {
  ImproveOptions here;
  here.ops = options.ops;
  here.seed = options.seed;
  here.time_limit = seconds;
  here.raise_min_dihedral = true;  // as many vertices as it takes
  Outcome best;
  best.worst = survey(patch.mesh(), here.policy).worst;
  const double enough = dihedral_decision(goal);
  for (int i = 0; i <= n_sites && best.worst < enough; ++i) {  // the first without a new vertex
    TetMesh mesh = patch.mesh();
    Workspace work;
    work.attach(mesh, here.policy);
    if (i > 0) {
      work.set_qualities(mesh, MinSine2{}, here.policy);
      VertexInsertion<MinSine2> insertion{MinSine2{}, work.quality, kLoss};
      insertion.only_site = i - 1;
      if (!apply(insertion, mesh, VertexInsertion<MinSine2>::Seed(CellHandle(0)))) continue;
      work.attach(mesh, here.policy);
    }
    RunControl control(here);
    polish(mesh, work, here, control, std::min(kAhead * goal, kLargestGoal));
    const double worst = survey(mesh, here.policy).worst;
    if (!(worst > best.worst)) continue;
    best.worst = worst;
    best.mesh = std::move(mesh);
  }
  return best;
}

/// Whether the mesh keeps to the bounds on its cells with this in place of the patch.
bool fits(const TetMesh& mesh, const Patch& patch, const TetMesh& changed, const ImproveOptions& options) {
  const std::size_t n = mesh.n_logical_cells() - patch.cells().size() + changed.n_logical_cells();
  return n >= options.min_cells && (options.max_cells == 0 || n <= options.max_cells);
}

}  // namespace

bool search_patches(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
                    double goal, const PatchEffort& effort) {
  if (!has(options.ops, Ops::kInsert) || control.surface() || options.iterations > 0) return false;
  if (!(survey(mesh, options.policy).worst > 0)) return false;
  PassReport pass;
  pass.stage = "patches";
  pass.op = "insert";
  const double start = control.seconds();
  for (int turn = 0; turn < effort.turns && !control.stopped(); ++turn) {
    const double next = std::min(goal, smallest_dihedral(mesh, options.policy) + effort.degrees);
    std::vector<Patch> patches;
    std::vector<std::uint8_t> taken(mesh.n_cells(), 0);
    for (CellHandle c : worst_cells_below(mesh, next, 4 * effort.patches, options.policy)) {
      if (patches.size() == effort.patches) break;
      if (taken[c.idx()]) continue;
      Patch patch(mesh, c, effort.layers);
      const auto& cells = patch.cells();
      if (std::any_of(cells.begin(), cells.end(), [&](CellHandle d) { return taken[d.idx()] != 0; }))
        continue;
      for (CellHandle d : cells) taken[d.idx()] = 1;
      patches.push_back(std::move(patch));
    }
    if (patches.empty()) break;
    std::vector<Outcome> outcomes(patches.size());
    const double seconds = options.time_limit - control.seconds();
    par::for_each_dynamic(
        options.policy.for_items_of(kPatchNanoseconds), patches.size(), 1,
        [&](std::size_t i) { outcomes[i] = search(patches[i], options, seconds, next, effort.tries); });
    ++pass.rounds;
    pass.seeds += patches.size();
    std::size_t n_changed = 0;
    bool worst_rose = false;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      if (!outcomes[i].mesh) continue;
      ++pass.candidates;
      if (!fits(mesh, patches[i], *outcomes[i].mesh, options)) {
        control.note_cell_bound();
        continue;
      }
      patches[i].put_back(mesh, *outcomes[i].mesh);
      ++n_changed;
      worst_rose = worst_rose || i == 0;
    }
    pass.winners += n_changed;
    if (n_changed > 0) work.attach(mesh, options.policy);
    if (!worst_rose) break;
  }
  pass.worst = survey(mesh, options.policy).worst;
  pass.seconds = control.seconds() - start;
  const bool changed = pass.winners > 0;
  control.add(std::move(pass));
  return changed;
}

}  // namespace hfr
