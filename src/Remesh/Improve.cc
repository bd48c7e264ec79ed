// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Improve.hh"

#include <algorithm>
#include <array>

#include "HalfFace/Errors.hh"
#include "HalfFace/Reorder.hh"
#include "Quality/FoldedFaces.hh"
#include "Quality/UnfillableFaces.hh"
#include "Remesh/Coordinates.hh"
#include "Remesh/Pipeline.hh"
#include "Remesh/RunControl.hh"
#include "Remesh/SurfaceRun.hh"
#include "Remesh/Trial.hh"

namespace hfr {
namespace {

constexpr double kLargestGoal = 70.5;  // the regular tetrahedron has 70.53
/// Degrees; where no goal is given, the worst cells are raised from one of these to the next.
constexpr std::array<double, 13> kLadder = {1, 2, 4, 7, 10, 15, 20, 22.5, 25, 27.5, 30, 32.5, 35};
constexpr double kCommonRung = 25;
constexpr double kReliefRung = 30;
/// Up to here patches are searched where the surface may change its shape: they do not know it, and there are
/// cheaper ways beyond.
constexpr double kPatchRungFree = 20;
/// The same where the worst is to be raised at any cost, until this many rungs in a row have not raised it by
/// this factor.
constexpr std::array<double, 23> kFullLadder = {1,  2,    3,  4,    5.5, 7,    8.5,  10,   12, 14,   16, 18,
                                                20, 22.5, 25, 27.5, 30,  32.5, 35.0, 37.5, 40, 42.5, 45};
/// Of these, 37.5 and 42.5 only from here on: for meshes that end far below they would be two more of the
/// rungs that are worked for in vain.
constexpr double kHalfRungsFrom = 30;
constexpr bool is_half_rung(double rung) { return rung == 37.5 || rung == 42.5; }
constexpr int kMaxMissed = 4;
constexpr double kClimbGain = 1.002;
/// Nor left fewer than this share of the cells that were below the rung.
constexpr double kFewer = 0.8;
/// And climbs all of them again if a search of the worst cells has raised it by this factor.
constexpr double kClimbAgain = 1.02;
/// Where the surface may change its shape there is always something that gives way by little: the last cells
/// are relieved again only if the worst has risen by this factor.
constexpr double kReliefGain = 1.02;
/// Where more than this share of the cells stays below so many degrees after the bulk stage, vertices are
/// missing rather than badly connected, and are put in first.
constexpr double kManyPoor = 0.08;
/// Where more than this share does, it is the mesh that is poor: vertices would not get it there either.
constexpr double kAllPoor = 0.6;
/// Where more than this share misses a goal that was asked for, all cells are worked on before it is worked
/// for: most would be touched anyway, and polished by themselves they would lose too many vertices.
constexpr double kManyMiss = 0.2;
/// Where no more than this share is left in the end, a frozen surface holds them, whatever is done to others.
constexpr double kFewMiss = 0.01;
constexpr double kRefineGoal = 30;
/// What a new vertex must do there for sin² of the worst of its cells; the second where cells may be many.
constexpr double kRefineGain = 1.6;
constexpr double kRefineGainAtAnyCost = 1.3;
/// Cells that raising the worst angle at any cost makes of 100 that the default run leaves, where the options
/// do not say. With a surface whose facets stay planar it needs no more than otherwise; with one that may
/// change its shape, a single cell that nothing mends would draw vertices without end: 20 cells came
/// to 14,842 in 12 s (unittests/Fuzz, case 10791).
constexpr std::size_t kMostAtAnyCost = 150;
/// Of 100 cells that a run may make, those that there may be when vertices are put in first, and once more.
/// The rest is for the worst cells.
constexpr std::size_t kFillOfHundred = 92;
constexpr std::size_t kFillUpOfHundred = 98;
constexpr std::size_t kFillAtAnyCost = 90;
constexpr std::size_t kFillUpAtAnyCost = 96;
/// Degrees below which cells are worked on before the bulk stage.
constexpr double kEarlyGoal = 15;
/// Where the bulk stage has left more cells below a goal nobody asked for, the mesh as a whole is beyond it,
/// and going on would only remove vertices.
constexpr double kLargestShare = 0.1;

/// Cells that a run may leave of 100, and make of them, where the options do not say.
constexpr std::size_t kLeastOfHundred = 81;
constexpr std::size_t kMostOfHundred = 119;

/// Whether the number of cells is to stay about what it is where the options do not say. A surface that may
/// change gives its cells good angles with fewer or more vertices, as they are needed; but where a goal was
/// asked for or the worst angle is raised at any cost, small meshes would come to several times their cells,
/// and others would lose so many that there is no room left to work in. (In free mode neither was seen.)
bool keeps_size(const ImproveOptions& options) {
  if (options.compat != Compat::kNone || (options.raise_min_dihedral && options.coarsen)) return false;
  switch (options.surface.mode) {
    case SurfaceMode::kFrozen:
      return true;
    case SurfaceMode::kFlat:
      return options.raise_min_dihedral || options.min_dihedral;
    case SurfaceMode::kFree:
      return false;
  }
  return false;
}

ImproveOptions with_cell_bounds(ImproveOptions options, std::size_t n_cells) {
  if (options.coarsen && options.max_cells == 0) options.max_cells = n_cells;
  const bool keeps = keeps_size(options);
  if (!options.coarsen) options.raise_min_dihedral = false;  // that comes after
  if (!keeps) return options;
  // Towards a goal a flat surface gives its cells good angles with fewer of them, in a third of the time.
  const bool may_lose =
      options.coarsen || (options.surface.mode == SurfaceMode::kFlat && options.min_dihedral);
  if (options.min_cells == 0 && !may_lose) options.min_cells = n_cells * kLeastOfHundred / 100;
  if (options.max_cells == 0) options.max_cells = n_cells * kMostOfHundred / 100;
  return options;
}

/// Share of the cells with a dihedral below so many degrees.
double share_below(const TetMesh& mesh, double degrees, const ImproveOptions& options) {
  return static_cast<double>(n_below(mesh, degrees, options.policy)) /
         static_cast<double>(mesh.n_logical_cells());
}

/// With a surface that may change its shape, what many cells suffer from can be mended, too. Beyond the angle
/// that such runs are for, that is dear: noisy surfaces would cost twice what they cost frozen.
double largest_share(const ImproveOptions& options, double rung) {
  constexpr double kFreeUpTo = 20, kUpToThere = 0.35, kBeyond = 0.2;
  if (!is_free(options)) return kLargestShare;
  return rung > kFreeUpTo ? kBeyond : kUpToThere;
}

void validate(const ImproveOptions& options) {
  HFR_REQUIRE(!options.min_dihedral || (*options.min_dihedral > 0 && *options.min_dihedral < kLargestGoal),
              "the smallest dihedral asked for must lie between 0 and 70.5 degrees, not " +
                  std::to_string(options.min_dihedral.value_or(0)));
  HFR_REQUIRE(
      !options.min_dihedral || !options.raise_min_dihedral,
      "raise_min_dihedral asks for the largest angle that can be had, min_dihedral for a certain one: "
      "give one of them");
  HFR_REQUIRE(options.iterations >= 0, "the number of iterations must not be negative");
  HFR_REQUIRE(options.time_limit > 0, "the time limit must be positive");
  HFR_REQUIRE(options.ops != Ops::kNone, "there is no operator to work with");
  HFR_REQUIRE(options.policy.threads >= 1, "the number of threads must be at least 1");
}

/// The angles up to a goal that the worst cells are raised to on the way there, and the goal itself if one
/// was asked for.
std::vector<double> rungs_to(double goal) {
  std::vector<double> rungs;
  for (double rung : kLadder)
    if (rung < goal) rungs.push_back(rung);
  if (goal < kLargestGoal) rungs.push_back(goal);
  return rungs;
}

/// Raises the worst dihedrals rung by rung; one that is missed is no reason to stop, because what holds a
/// cell below it may give way on the next.
void climb_rungs(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
                 double goal) {
  double now = smallest_dihedral(mesh, options.policy);
  double below = 0;  // the last rung that was worked for
  for (double rung : rungs_to(goal)) {
    if (control.stopped()) return;
    if (now >= rung) continue;
    // Beyond what most meshes come to, only from a rung that was reached: many cells lie below the next.
    if (rung > kCommonRung && now < below) break;
    below = rung;
    polish(mesh, work, options, control, rung, largest_share(options, rung));
    now = smallest_dihedral(mesh, options.policy);
  }
}

const PatchEffort& little_effort(const RunControl& control) {
  return control.surface() ? kSurfaceEffort : kLittleEffort;
}

/// Mends the last few cells below the first rung that was missed, and those below the next ones up to the
/// goal. True when the worst has risen.
bool mend_last(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
               const PatchEffort& effort, double goal = kLargestGoal) {
  const auto smallest = [&] { return smallest_dihedral(mesh, options.policy); };
  const double at_first = smallest();
  const double gain = is_free(options) ? kReliefGain : kClimbGain;
  double now = at_first;
  for (double rung : rungs_to(goal)) {
    const bool asked_for = options.coarsen || options.min_dihedral;
    if (now >= goal || (rung > kReliefRung && !asked_for) || control.stopped()) break;
    if (now >= rung) continue;
    if (share_below(mesh, rung, options) > largest_share(options, rung)) break;
    const auto search = [&](const PatchEffort& how) {
      if (now < rung && search_patches(mesh, work, options, control, rung, how)) now = smallest();
    };
    // The surroundings of a flat surface take vertices wherever they may; towards a goal patches need fewer.
    if (options.min_dihedral && options.surface.mode == SurfaceMode::kFlat) search(effort);
    for (double before = 0; now < rung && now > gain * before && !control.stopped();) {
      before = now;
      relieve(mesh, work, options, control, few_below(mesh, rung, options.policy));
      now = smallest();
    }
    if (!is_free(options) || rung <= kPatchRungFree) {
      search(effort);
      for (const PatchEffort& last : kLastEfforts) search(last);
    }
    if (now < rung) break;
  }
  // An invalid cell that cannot become valid has not risen by staying what it is.
  if (control.unfillable() && at_first <= 0) return now > at_first;
  return now > kClimbGain * at_first;
}

/// Puts vertices in up to that many of 100 cells that the run may make, where that is worth it; that this
/// bound was met is nothing that the run has to tell.
void refine_within(TetMesh& mesh, Workspace& work, ImproveOptions options, RunControl& control,
                   std::size_t of_hundred, double gain) {
  const bool met_bound = control.met_cell_bound();
  if (options.max_cells > 0)
    options.max_cells = std::max<std::size_t>(options.max_cells * of_hundred / 100, 1);
  Trial trial(mesh, work, options, control, kRefineGoal);
  refine(mesh, work, options, control, kRefineGoal, gain);
  trial.settle();
  if (!met_bound) control.forget_cell_bound();
}

/// Puts vertices in where the mesh lacks them. True when it does.
bool fill_in(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
             std::size_t of_hundred) {
  if (control.surface() || control.stopped() || smallest_dihedral(mesh, options.policy) >= kRefineGoal)
    return false;
  const double share = share_below(mesh, kRefineGoal, options);
  if (share <= kManyPoor || share >= kAllPoor) return false;
  refine_within(mesh, work, options, control, of_hundred, kRefineGain);
  return true;
}

/// Raises the worst dihedrals as far as a limited effort takes them. `floor` is where the worst stood before:
/// the bulk stage, which knows only volume-length, may have lowered it.
void climb(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control, double floor,
           const PatchEffort& effort, double goal) {
  if (smallest_dihedral(mesh, options.policy) < floor) polish(mesh, work, options, control, floor);
  fill_in(mesh, work, options, control, kFillOfHundred);
  climb_rungs(mesh, work, options, control, goal);
  // What was put in first is well connected by now, which shows where vertices are still missing.
  if (options.iterations == 0 && fill_in(mesh, work, options, control, kFillUpOfHundred))
    climb_rungs(mesh, work, options, control, goal);
  // Whatever raises the last few takes from their neighbours.
  if (mend_last(mesh, work, options, control, effort, goal)) climb_rungs(mesh, work, options, control, goal);
}

/// What a run does of itself: the damage, all cells in volume-length, then the worst angles, up to the goal
/// if there is one. `floor`: see climb().
void improve_all(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
                 double floor, const PatchEffort& effort, double goal) {
  // The worst angles first: the bulk stage, which knows only volume-length, can box them in. Few cells, so
  // kind by kind, as towards a goal.
  ImproveOptions early = options;
  if (early.rounds == Rounds::kAuto) early.rounds = Rounds::kByKind;
  polish(mesh, work, early, control, kEarlyGoal, kLargestShare);
  if (options.coarsen) coarsen(mesh, work, options, control);
  improve_bulk(mesh, work, options, control);
  control.set_fraction(0.5);
  climb(mesh, work, options, control, floor, effort, goal);
}

/// Works towards a goal: within the bounds on cells first, then within those that were asked for if the
/// former were in the way. What misses it is raised as far as it goes, rung by rung, the last few cells with
/// more effort, and tried once more if that has helped. `from_the_worst`: nothing else has been worked on,
/// and all cells are if that was not enough.
bool reach(TetMesh& mesh, Workspace& work, const ImproveOptions& options, const ImproveOptions& as_asked,
           RunControl& control, double goal, bool from_the_worst) {
  const auto smallest = [&] { return smallest_dihedral(mesh, options.policy); };
  const auto attempt = [&](const ImproveOptions& within) {
    if (polish(mesh, work, within, control, goal)) return true;
    const double missed_at = smallest();
    climb_rungs(mesh, work, within, control, goal);
    if (!control.stopped()) mend_last(mesh, work, within, control, little_effort(control), goal);
    return !control.stopped() && smallest() > missed_at && polish(mesh, work, within, control, goal);
  };
  if (attempt(options)) return true;
  const ImproveOptions* now = &options;
  if (control.met_cell_bound() && !control.stopped()) {
    control.forget_cell_bound();
    Trial trial(mesh, work, options, control, goal);
    if (attempt(as_asked)) return true;
    if (trial.settle()) now = &as_asked;
  }
  if (control.stopped() || options.iterations > 0) return false;
  const bool many_miss = from_the_worst && share_below(mesh, goal, options) > kFewMiss;
  if (!control.surface() && !many_miss) return false;
  Trial trial(mesh, work, options, control, goal);
  if (control.surface()) {
    // Work for more makes room that the goal's last cells lack.
    const auto onwards = from_the_worst ? improve_all : climb;
    onwards(mesh, work, *now, control, smallest(), little_effort(control), kLargestGoal);
  } else {
    improve_all(mesh, work, *now, control, smallest(), little_effort(control), goal);
  }
  if (polish(mesh, work, *now, control, goal)) return true;
  trial.settle();
  return false;
}

/// Whether the worst angle has, by that factor, and by what shows in a table; 0 before: anything is a gain.
bool has_risen(double now, double before, double factor) {
  return now > (before > 0 ? std::max(before * factor, before + kLeastRise) : 0);
}

/// Climbs again and again, and beyond rungs that are missed, while the worst rises.
void climb_beyond(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control) {
  const auto smallest = [&] { return smallest_dihedral(mesh, options.policy); };
  for (double at_start = 0; has_risen(smallest(), at_start, kClimbGain) && !control.stopped();) {
    at_start = smallest();
    int n_missed = 0;
    for (double rung : kFullLadder) {
      const double now = smallest();
      if (now >= rung || (is_half_rung(rung) && now < kHalfRungsFrom)) continue;
      if (n_missed == kMaxMissed || control.stopped()) break;
      const auto n_poor = n_below(mesh, rung, options.policy);
      Trial trial(mesh, work, options, control, rung);
      polish(mesh, work, options, control, rung);
      if (options.coarsen) relieve(mesh, work, options, control, rung);
      trial.settle();
      const bool fewer =
          kFewer * static_cast<double>(n_poor) > static_cast<double>(n_below(mesh, rung, options.policy));
      n_missed = fewer || has_risen(smallest(), now, kClimbGain) ? 0 : n_missed + 1;
    }
    if (control.stopped()) return;
    const double last = few_below(mesh, kFullLadder.back(), options.policy);
    Trial trial(mesh, work, options, control, last);
    relieve(mesh, work, options, control, last);
    trial.settle();
  }
}

/// The same, with the worst cells tried on copies of their surroundings before and after, which may take the
/// worst beyond rungs that were missed, and with vertices put in where they are missing, twice.
void climb_while_it_helps(TetMesh& mesh, Workspace& work, const ImproveOptions& options,
                          RunControl& control) {
  const auto smallest = [&] { return smallest_dihedral(mesh, options.policy); };
  const auto search_worst = [&] {
    for (const PatchEffort& effort : kAllEfforts)
      search_patches(mesh, work, options, control, kFullLadder.back(), effort);
  };
  search_worst();
  const auto put_in = [&](std::size_t of_hundred) {
    if (control.surface() || control.stopped() || options.coarsen || smallest() >= kRefineGoal) return;
    refine_within(mesh, work, options, control, of_hundred, kRefineGainAtAnyCost);
  };
  put_in(kFillAtAnyCost);
  for (double at_start = 0; has_risen(smallest(), at_start, kClimbAgain) && !control.stopped();) {
    climb_beyond(mesh, work, options, control);
    if (at_start == 0) put_in(kFillUpAtAnyCost);
    at_start = smallest();
    search_worst();
  }
}

/// The boundary faces that leave no mesh without invalid cells.
std::vector<HalfFaceHandle> find_unfillable(const TetMesh& mesh, const std::vector<CellHandle>& invalid,
                                            const std::vector<HalfFaceHandle>& folded, par::Policy policy) {
  std::vector<HalfFaceHandle> suspects = folded;
  for (CellHandle c : invalid)
    for (int k = 0; k < 4; ++k)
      if (mesh.is_boundary(halfface_of(c, k))) suspects.push_back(halfface_of(c, k));
  std::sort(suspects.begin(), suspects.end());
  suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
  return unfillable_faces(mesh, suspects, policy);
}

/// True when every cell is known to meet the goal.
bool run_stages(TetMesh& mesh, Workspace& work, const ImproveOptions& as_asked, RunControl& control,
                const Survey& at_first) {
  const ImproveOptions options = with_cell_bounds(as_asked, mesh.n_logical_cells());
  if (options.compat == Compat::kJpdc2013) {
    run_jpdc2013(mesh, work, options, control);
    return false;
  }
  const double floor = report_value(Metric::kMinDihedral, std::clamp(at_first.worst, 0.0, 8.0 / 9.0));
  if (at_first.n_invalid > 0) untangle(mesh, work, options, control);
  if (at_first.n_invalid > 0 && !control.surface()) {
    const std::vector<CellHandle> left = invalid_cells(mesh, options.policy);
    control.set_unfillable(
        !left.empty() &&
        !find_unfillable(mesh, left, folded_faces(mesh, options.policy), options.policy).empty());
  }
  control.set_fraction(0.1);
  const double goal = options.min_dihedral.value_or(kLargestGoal);
  const bool few_miss = options.min_dihedral && !options.coarsen &&
                        (options.iterations > 0 || share_below(mesh, goal, options) <= kManyMiss);
  const PatchEffort& effort = as_asked.raise_min_dihedral ? kAllEfforts[0] : little_effort(control);
  if (!few_miss) improve_all(mesh, work, options, control, floor, effort, goal);
  if (options.min_dihedral) return reach(mesh, work, options, as_asked, control, goal, few_miss);
  if (as_asked.raise_min_dihedral) {
    control.forget_cell_bound();
    control.spare_nothing();
    ImproveOptions further = as_asked;
    further.min_cells = options.min_cells;  // what is left out now is missing for the last cells
    const bool as_before = options.coarsen || options.surface.mode == SurfaceMode::kFlat;
    if (further.max_cells == 0)
      further.max_cells = as_before ? options.max_cells : mesh.n_logical_cells() * kMostAtAnyCost / 100;
    climb_while_it_helps(mesh, work, further, control);
  }
  return false;
}

/// All stages. Over inverted or flat cells first without holding each cluster to being no more damaged: from
/// a state between that is worse, more of them come right. Where the mesh ends worse for it than it began,
/// again from the beginning, and held.
bool run_twice_if_worse(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
                        const Survey& at_first) {
  const auto run_all = [&] {
    const bool met = run_stages(mesh, work, options, control, at_first);
    restore_volume(mesh, work, options, control);
    return met;
  };
  if (at_first.n_invalid == 0) return run_all();
  work.floor = at_first.worst;
  Snapshot before(mesh, control);
  work.holds_damage = false;
  const bool met = run_all();
  work.holds_damage = true;
  if (met || control.stopped() || control.checkpoint()->allows(mesh)) return met;
  before.put_back(mesh, work, control, options.policy);
  return run_all();
}

/// The first angle that the worst cells were raised to in vain.
double missed_rung(double smallest, bool to_the_end) {
  const auto first_above = [&](const auto& ladder) {
    const auto at = std::find_if(ladder.begin(), ladder.end(), [&](double rung) { return rung > smallest; });
    return at == ladder.end() ? 0.0 : *at;
  };
  return to_the_end ? first_above(kFullLadder) : first_above(kLadder);
}

/// What ended the run before it was done; kNotFound where nothing did.
Limit ended_by(const ImproveOptions& options, const Result& result) {
  switch (result.stop) {
    case Stop::kTimeLimit:
      return Limit::kTimeLimit;
    case Stop::kCancelled:
      return Limit::kCancelled;
    case Stop::kDeviceLost:
      return Limit::kDeviceLost;
    case Stop::kIterations:
      // Only where the last one that was allowed still changed something.
      return std::any_of(result.passes.begin(), result.passes.end(),
                         [&](const PassReport& pass) {
                           return pass.iteration == options.iterations && pass.winners > 0 &&
                                  (pass.stage == "bulk" || pass.stage == "polish");
                         })
                 ? Limit::kIterations
                 : Limit::kNotFound;
    case Stop::kGoal:
    case Stop::kNoProgress:
      break;
  }
  return Limit::kNotFound;
}

/// What keeps the cells that are left below the goal.
void explain(const TetMesh& mesh, const ImproveOptions& options, std::size_t max_cells_met, Result& result) {
  result.stuck_below = options.min_dihedral
                           ? *options.min_dihedral
                           : missed_rung(result.after.min_dihedral.min, options.raise_min_dihedral);
  if (result.stuck_below == 0) return;
  std::vector<StuckCell>& stuck = result.stuck;
  stuck = stuck_cells(mesh, result.stuck_below, result.unfillable_faces, options.policy);
  const bool frozen = options.surface.mode == SurfaceMode::kFrozen;
  if (!frozen) blame_features(mesh, stuck, result.stuck_below, options);
  const Limit ended = ended_by(options, result);
  for (StuckCell& cell : stuck)
    if (cell.limit == Limit::kNotFound) cell.limit = ended;
  if (max_cells_met > 0 && has(options.ops, Ops::kInsert))
    blame_max_cells(mesh, stuck, result.stuck_below, max_cells_met, options.policy);
  if (frozen) result.held = held_cells(mesh, stuck, result.stuck_below, options);
}

/// Before the end of a run that may have left the mesh worse than its input: works on what has fallen below
/// the input's smallest angle, if that is all, and puts back what was kept if that does not do. False when it
/// did that.
bool settle(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
            bool known_to_meet) {
  Checkpoint& checkpoint = *control.checkpoint();
  const auto mend = [&] {
    if (control.stopped() || options.compat != Compat::kNone) return;
    polish_to(mesh, work, options, control, checkpoint.input().worst);
  };
  if (!checkpoint.settle(mesh, known_to_meet, mend)) return true;
  const Survey found = survey(mesh, options.policy);
  PassReport pass;
  pass.stage = pass.op = "undo";
  pass.n_inverted = found.n_invalid;
  pass.worst = found.worst;
  control.add(std::move(pass));
  control.take_back_changes(checkpoint.changes_kept());
  return false;
}

/// True when every cell is known to meet the goal. `order`: where each vertex and cell went, if the cells
/// were reordered.
bool run(TetMesh& mesh, const ImproveOptions& options, RunControl& control, const Survey& at_first,
         GarbageMap& order, SurfaceReport& surface_report) {
  // Most of a run over everything is walking from cell to cell; a goal run touches too little to pay for it.
  if (!options.min_dihedral && is_scattered(mesh, options.policy))
    order = reorder(mesh, {.curve = SpaceCurve::kMorton, .vertices = false, .policy = options.policy});
  if (at_first.n_invalid > 0) control.keep(mesh, false);
  std::vector<PassReport> unfolding;
  const SurfaceRun surface(mesh, options, at_first.n_invalid > 0, unfolding);
  for (PassReport& pass : unfolding) control.add(std::move(pass));
  Workspace work;
  work.attach(mesh, options.policy);
  control.set_folded(!folded_faces(mesh, options.policy).empty());
  // Elsewhere no new edge or face can come twice while all cells are positive, and there is no copy to make.
  if (control.is_folded() || !work.pinched.empty()) control.keep(mesh, at_first.n_invalid == 0);
  control.set_surface(surface.get());
  bool met = run_twice_if_worse(mesh, work, options, control, at_first);
  met = settle(mesh, work, options, control, met) && met;
  control.set_surface(nullptr);
  surface_report = surface.report(mesh);
  return met;
}

/// Gives the mesh handles without gaps, in the old order where nothing has changed. Returns where each vertex
/// and cell went; nothing where they stay.
GarbageMap tidy(TetMesh& mesh, const ImproveOptions& options, bool changed, const GarbageMap& order) {
  if (changed) return mesh.collect_garbage();
  GarbageMap map;
  if (order.cells.empty()) return map;
  map.cells.resize(mesh.n_cells());
  std::size_t n = 0;
  for (CellHandle c : order.cells)
    if (c.is_valid()) map.cells[c.idx()] = CellHandle(n++);
  restore_cell_order(mesh, order.cells, options.policy);
  return map;
}

Stop reason_to_stop(const RunControl& control, const ImproveOptions& options, bool goal_reached) {
  if (control.reason()) return *control.reason();
  if (goal_reached && options.min_dihedral) return Stop::kGoal;
  return options.iterations > 0 ? Stop::kIterations : Stop::kNoProgress;
}

/// Fills in what is said of a mesh that is not known to meet the goal.
void look_for_faults(const TetMesh& mesh, const Survey& found, par::Policy policy, Result& result) {
  if (found.n_invalid == 0) return;
  result.invalid_cells = invalid_cells(mesh, policy);
  result.folded_faces = folded_faces(mesh, policy);
  result.unfillable_faces = find_unfillable(mesh, result.invalid_cells, result.folded_faces, policy);
}

}  // namespace

Result improve(TetMesh& mesh, const ImproveOptions& options) {
  validate(options);
  require_sound_coordinates(mesh, options.policy);
  Result result;
  if (options.statistics) result.before = statistics(mesh, options.policy);
  RunControl control(options);
  const double goal = options.min_dihedral ? dihedral_decision(*options.min_dihedral) : 0.0;
  const auto meets_goal = [&](const Survey& found) { return found.n_invalid == 0 && found.worst >= goal; };
  Survey found = survey(mesh, options.policy);
  Checkpoint checkpoint(mesh, found, options.policy);
  control.set_checkpoint(&checkpoint);
  const bool nothing_to_do = options.min_dihedral && options.compat == Compat::kNone && meets_goal(found);
  if (!nothing_to_do) {
    const double before = control.seconds();
    control.open_device(mesh);
    if (control.device()) result.device = control.device()->info().name;
    result.seconds_device = control.seconds() - before;
  }
  std::optional<MapRecorder> recorder;
  if (options.maps) recorder.emplace(mesh);
  GarbageMap order;
  bool known_to_meet = nothing_to_do;
  try {
    if (!nothing_to_do) known_to_meet = run(mesh, options, control, found, order, result.surface);
  } catch (...) {  // of a callback, most likely
    checkpoint.settle_after_failure(mesh);
    tidy(mesh, options, !checkpoint.is_input(), order);
    throw;
  }
  result.passes = std::move(control.passes());
  result.device_note = control.device_note();
  if (control.device()) result.kernel_times = control.device()->profile();
  result.changed = control.n_changes() > 0;
  const GarbageMap garbage = tidy(mesh, options, result.changed, order);
  if (recorder) result.maps = recorder->maps(order, garbage);
  if (!known_to_meet) {
    if (result.changed) found = survey(mesh, options.policy);
    look_for_faults(mesh, found, options.policy, result);
  }
  result.goal_reached = known_to_meet || meets_goal(found);
  result.stop = reason_to_stop(control, options, result.goal_reached);
  result.seconds = control.seconds();
  if (options.statistics) {
    result.after = result.changed ? statistics(mesh, options.policy) : result.before;
    explain(mesh, options, control.max_cells_met(), result);
    for (const std::uint32_t size : star_sizes(mesh)) result.n_large_stars += size > Star::kCapacity ? 1 : 0;
  }
  return result;
}

}  // namespace hfr
