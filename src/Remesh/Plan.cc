// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <iomanip>
#include <sstream>
#include <vector>

#include "Quality/Metrics.hh"
#include "Remesh/Improve.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

/// A sentence of words and numbers, these as short as they can be.
template <class... Words>
std::string say(const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  return text.str();
}

std::string percent(double share) { return say(100 * share, " %"); }

std::string listed(const std::vector<TargetAngle>& targets) {
  std::ostringstream text;
  for (const TargetAngle& target : targets) {
    text << (&target == targets.data() ? "" : ", ") << target.degrees;
    if (target.from > 0) text << " (from " << target.from << ')';
  }
  return text.str();
}

std::string named(Selection selection) {
  switch (selection) {
    case Selection::kByKind:
      return "kinds of operators in turn";
    case Selection::kMixedOnAngles:
      return "kinds of operators in one selection where angles are raised";
    case Selection::kMixed:
      return "kinds of operators in one selection";
  }
  return {};
}

std::string named(Course course) {
  switch (course) {
    case Course::kDefault:
      return "default";
    case Course::kGoal:
      return "goal";
    case Course::kAnyCost:
      return "any cost";
    case Course::kCompat:
      return "jpdc2013";
  }
  return {};
}

/// Lines of a plan: the name of a stage, then what it does.
class Lines {
 public:
  void add(const std::string& stage, const std::string& what) {
    constexpr int kWidth = 16;
    text_ << std::left << std::setw(kWidth) << (stage == last_ ? "" : stage) << what << '\n';
    last_ = stage;
  }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::string last_;
};

void add_bounds(Lines& lines, const std::string& stage, const CellBounds& bounds) {
  lines.add(stage, bounds.min > 0 ? say("no vertex is removed below ", bounds.min, " cells")
                                  : "vertices may be removed down to any number of cells");
  lines.add(stage, bounds.max > 0 ? say("no vertex is inserted above ", bounds.max, " cells")
                                  : "vertices may be inserted up to any number of cells");
}

void add_refine(Lines& lines, const std::string& stage, const RefineEffort& refine) {
  std::string when;
  if (refine.least_share >= 0)
    when = say(" where ", percent(refine.least_share), " to ", percent(refine.largest_share),
               " of the cells are");
  lines.add(stage, say("vertices for cells below ", refine.below, " degrees", when, ", up to ",
                       refine.of_hundred, " of 100 cells that there may be"));
  lines.add(stage, say("each raises sin² of the worst of its cells by ", refine.gain,
                       "; until fewer than 1 in ", refine.one_in, " poor cells gets one"));
}

void add_patches(Lines& lines, const std::string& stage, const PatchEffort& effort) {
  lines.add(stage, say("patches of ", effort.layers, " layers round at most ", effort.few, " cells, ",
                       effort.patches, " at a time, ", effort.turns, " turns, ", effort.degrees,
                       " degrees beyond the worst; tries: ", effort.rows, " rows of apexes, ",
                       effort.vertices, " new vertices, ", effort.removals, " removals",
                       effort.replaces ? ", each with and without a new vertex" : ""));
}

void add_all_cells(Lines& lines, const Strategy& strategy) {
  const FirstPolish& first = strategy.first_polish;
  lines.add("first polish", say("cells below ", first.target, " degrees, if at most ",
                                percent(first.largest_share), " of all; ", named(first.polish.selection)));
  if (strategy.coarsen)
    lines.add("coarsen", say("vertices out of cells below ", strategy.coarsen->below, " degrees, ",
                             strategy.coarsen->iterations, " iterations, while each takes ",
                             percent(1 - strategy.coarsen->still), " of the cells"));
  const BulkEffort& bulk = strategy.bulk;
  lines.add("bulk",
            say("all cells", std::isfinite(bulk.focus) ? say(" of decision value below ", bulk.focus) : "",
                " in ", metric_name(bulk.metric), ", ", bulk.iterations, " iterations",
                bulk.removes_vertices ? ", with vertex collapse" : ""));
  lines.add("floor", say("cells below ", strategy.floor, " degrees, the input's worst"));
}

void add_targets(Lines& lines, const Strategy& strategy, bool frozen) {
  const PolishEffort& polish = strategy.polish;
  if (strategy.refine) add_refine(lines, "refine", *strategy.refine);
  lines.add("targets", say("degrees: ", listed(strategy.targets.targets)));
  std::string many = percent(strategy.targets.targets.back().largest_share);
  if (const double first = strategy.targets.targets.front().largest_share;
      first != strategy.targets.targets.back().largest_share)
    many = say(percent(first), ", of the last ones ", many, ",");
  std::string when = strategy.claimed ? "not before the end of the run" : "not at all";
  if (frozen)
    when = say("only if the one before has left less than ", percent(strategy.targets.enough_left),
               " of those below it");
  lines.add("targets", say("where more than ", many, " of the cells are below, ", when));
  if (strategy.targets.in_turn_beyond < strategy.targets.targets.back().degrees)
    lines.add("targets",
              say("beyond ", strategy.targets.in_turn_beyond, " only if the one before was reached"));
  const ThroughoutEffort& throughout = strategy.throughout;
  lines.add("targets",
            say("there an iteration has to mend 1 in ", throughout.polish.least_fewer,
                " cells or raise the worst by ", throughout.polish.gain, "; vertices for all, up to ",
                throughout.of_hundred, " of 100 cells that there may be, until fewer than 1 in ",
                throughout.polish.seeds_of_vertex, " gets one"));
  lines.add("targets",
            say(polish.iterations, " iterations; ", polish.idle,
                " idle ones (no fewer cells, with many not 1 in ", polish.least_fewer,
                " fewer, and the worst not raised by ", polish.gain, ") end it; ", named(polish.selection)));
  lines.add("targets", say("vertices for at most ", polish.few_to_dig, " cells or 1 in ", polish.dig_share));
  if (strategy.refine_again) add_refine(lines, "refine again", *strategy.refine_again);
  const LastCellsEffort& last = strategy.last_cells;
  const std::string up_to = std::isfinite(last.up_to) ? say("targets up to ", last.up_to) : "all targets";
  lines.add("last cells", up_to);
  for (const PatchEffort& effort : last.patches_first) add_patches(lines, "last cells", effort);
  if (strategy.neighbourhoods) {
    const NeighbourhoodEffort& around = *strategy.neighbourhoods;
    std::ostringstream tries;
    for (const auto& attempt : around.tries)
      tries << (&attempt == around.tries.data() ? "" : ", ") << attempt.layers << " layers + "
            << attempt.degrees;
    lines.add("last cells",
              say("neighbourhoods of at most ", around.few, " cells: ", tries.str(), " degrees"));
  }
  if (strategy.patch.enabled)
    for (const PatchEffort& effort : last.patches) add_patches(lines, "last cells", effort);
}

void add_goal(Lines& lines, const Strategy& strategy, const GoalEffort& goal) {
  if (std::isfinite(goal.many_miss) && goal.many_miss >= 0)
    lines.add("goal",
              say("first the stages above, if more than ", percent(goal.many_miss), " of the cells miss it"));
  lines.add("goal",
            say("cells below ", goal.degrees, " degrees; then targets and last cells; then these again"));
  if (strategy.bounds.min != strategy.bounds_asked.min || strategy.bounds.max != strategy.bounds_asked.max)
    lines.add("goal", "the same without bounds that were not asked for, where these were in the way");
  if (goal.goes_on)
    lines.add("goal", say("all cells, if more than ", percent(goal.few_miss), " still miss it"));
}

/// What goes on where less was reached than the run claims, in the order of Pipeline.cc.
void add_claimed(Lines& lines, const Strategy& strategy, bool frozen) {
  if (!strategy.claimed) return;
  const Strategy& claimed = *strategy.claimed;
  const GoalEffort& goal = *claimed.goal;
  const std::string below = say("below ", goal.degrees, " degrees");
  lines.add("claimed",
            say("where cells ", below, " may rise", frozen ? ", and the bound on cells was in the way" : "",
                ": all cells, target by target up to that"));
  if (claimed.bounds_asked.max == 0 && claimed.bounds.max > 0)
    lines.add("claimed",
              say("up to ", claimed.bounds.max, " cells; up to ", goal.turns - 1, " times ", goal.more_cells,
                  " as many, while the worst rises by ", goal.pays * goal.degrees, " degrees"));
  else
    add_bounds(lines, "claimed", claimed.bounds);
  const auto from_the_start = [&](const std::string& run, const std::string& when) {
    lines.add("from the start", say(run, when, "; the better of both"));
  };
  if (strategy.towards_claim)
    from_the_start(say("the run towards ", goal.degrees, " degrees"), " where the mesh is poor throughout");
  if (strategy.frozen) lines.add("frozen", say("the run with a frozen surface, where cells are ", below));
  if (strategy.flat) from_the_start("the run with a flat surface", say(" where cells are ", below));
  const std::string which = frozen ? "up to that once more" : "from the first on that so many miss";
  lines.add("others", say("where more than ", percent(claimed.throughout.share), " of the cells are ", below,
                          ": the targets ", which, ", past those that mend next to nothing"));
  if (!frozen && strategy.targets.targets.back().degrees > goal.degrees)
    lines.add("others",
              say("where the first is beyond, once, while they raise the worst angle, unless up to ",
                  percent(goal.few_miss), " of the cells miss more than ", strategy.targets.may_be_missed,
                  " of those below it"));
  if (strategy.without_goal) from_the_start("the run without a goal", say(" where cells are ", below));
}

void add_any_cost(Lines& lines, const AnyCostEffort& effort) {
  if (effort.most_of_hundred > 0)
    lines.add("any cost", say("up to ", effort.most_of_hundred, " of 100 cells that there are by then"));
  else
    add_bounds(lines, "any cost", effort.bounds);
  for (const PatchEffort& patch : effort.patches) add_patches(lines, "any cost", patch);
  if (effort.refine) add_refine(lines, "any cost", *effort.refine);
  lines.add("any cost", say("degrees: ", listed(effort.targets)));
  lines.add("any cost", say("until ", effort.missed, " in a row are missed, again while the worst rises by ",
                            effort.gain, ", and from the patches on while it rises by ", effort.again));
}

}  // namespace

std::string plan(const TetMesh& mesh, const ImproveOptions& options) {
  validate(options);
  const Survey found = survey(mesh, options.policy);
  const Strategy strategy = resolve(options, found, mesh.n_logical_cells());
  Lines lines;
  lines.add("course", named(strategy.course));
  lines.add("operators", ops_to_list(strategy.pass.ops));
  if (strategy.course == Course::kCompat) {
    lines.add("jpdc2013", say(strategy.compat.iterations, " iterations: edge, face, node, smooth"));
    return lines.text();
  }
  const Strategy& first = strategy.usual ? *strategy.usual : strategy;
  const bool frozen = options.surface.mode == SurfaceMode::kFrozen;
  add_bounds(lines, "cells", first.bounds);
  if (strategy.untangle) {
    lines.add("untangle", say(found.n_invalid,
                              " cells: vertices moved together within 1, 3, 7 … layers while that brings "
                              "anything, then reconnected, again while fewer are left"));
  }
  if (strategy.goal && strategy.goal->polish_only) {
    const PolishEffort& polish = strategy.polish;
    lines.add("goal", say("the polish of cells below ", strategy.goal->degrees, " degrees alone, ",
                          polish.iterations, " iterations; ", polish.idle, " idle ones end it"));
    return lines.text();
  }
  if (strategy.goal && !std::isfinite(strategy.goal->many_miss)) {
    lines.add("all cells", "not before the goal was worked for");
  } else {
    add_all_cells(lines, first);
  }
  add_targets(lines, first, frozen);
  if (strategy.goal) add_goal(lines, strategy, *strategy.goal);
  add_claimed(lines, first, frozen);
  if (strategy.any_cost) add_any_cost(lines, *strategy.any_cost);
  if (strategy.volume)
    lines.add("volume", say("moved back to ", percent(strategy.volume->enough), ", ", strategy.volume->passes,
                            " passes"));
  return lines.text();
}

}  // namespace hfr
