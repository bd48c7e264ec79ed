// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Strategy.hh"

#include <string>

#include "HalfFace/Errors.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Survey.hh"

namespace hfr {
namespace {

/// Degrees. Where no goal is given, the worst cells are raised from one of these to the next.
constexpr std::array<double, 13> kTargets = {1, 2, 4, 7, 10, 15, 20, 22.5, 25, 27.5, 30, 32.5, 35};
/// The same where the worst angle is raised at any cost.
constexpr std::array<TargetAngle, 23> kTargetsAtAnyCost = {
    {{1},  {2},    {3},  {4},    {5.5}, {7},    {8.5}, {10},          {12}, {14},          {16}, {18},
     {20}, {22.5}, {25}, {27.5}, {30},  {32.5}, {35},  {37.5, 1, 30}, {40}, {42.5, 1, 30}, {45}}};

/// Cells that a run may leave of 100, and make of them, where the options do not say.
constexpr std::size_t kLeastOfHundred = 81;
constexpr std::size_t kMostOfHundred = 119;

/// Degrees that runs with a surface that may change its shape are for: beyond, what is dear is left for the
/// end, and patches are not searched.
constexpr double kFreeUpTo = 20;

/// The questions that the options are asked, each in one place.
class Asked {
 public:
  explicit Asked(const ImproveOptions& options) : options_(options) {}

  bool has_goal() const { return options_.min_dihedral.has_value(); }
  bool any_cost() const { return options_.raise_min_dihedral; }
  bool coarsens() const { return options_.coarsen; }
  bool is_compat() const { return options_.compat != Compat::kNone; }
  bool is_frozen() const { return options_.surface.mode == SurfaceMode::kFrozen; }
  bool is_flat() const { return options_.surface.mode == SurfaceMode::kFlat; }
  /// Whether the surface may change its shape.
  bool is_free() const { return options_.surface.mode == SurfaceMode::kFree; }
  bool limits_iterations() const { return options_.iterations > 0; }
  /// Whether the last few cells are searched for, each with what is round it.
  bool searches() const { return !limits_iterations() && !options_.passes_only; }
  int iterations_or(int most) const { return limits_iterations() ? options_.iterations : most; }
  const ImproveOptions& options() const { return options_; }

 private:
  const ImproveOptions& options_;
};

/// Whether the number of cells is to stay about what it is where the options do not say. A surface that may
/// change gives its cells good angles with fewer or more vertices, as they are needed; but where a goal was
/// asked for or the worst angle is raised at any cost, small meshes would come to several times their cells,
/// and others would lose so many that there is no room left to work in. (In free mode neither was seen.)
bool keeps_size(const Asked& asked) {
  return !asked.is_free() && (asked.is_frozen() || asked.any_cost() || asked.has_goal());
}

CellBounds bounds_of(const Asked& asked, std::size_t n_cells) {
  CellBounds bounds = {asked.options().min_cells, asked.options().max_cells};
  if (asked.coarsens() && bounds.max == 0) bounds.max = n_cells;
  if (asked.is_compat() || (asked.any_cost() && asked.coarsens())) return bounds;
  if (!keeps_size(asked)) {
    if (bounds.max == 0) bounds.max = static_cast<std::size_t>(kMoreCells * static_cast<double>(n_cells));
    return bounds;
  }
  // Towards a goal a flat surface gives its cells good angles with fewer of them, in a third of the time.
  const bool may_lose = asked.coarsens() || (asked.is_flat() && asked.has_goal());
  if (bounds.min == 0 && !may_lose) bounds.min = n_cells * kLeastOfHundred / 100;
  if (bounds.max == 0) bounds.max = n_cells * kMostOfHundred / 100;
  return bounds;
}

Selection selection_of(const Asked& asked) {
  const Ops ops = asked.options().ops;
  if (has(ops, Ops::kEdge) + has(ops, Ops::kFace) + has(ops, Ops::kNode) < 2) return Selection::kByKind;
  switch (asked.options().rounds) {
    case Rounds::kByKind:
      return Selection::kByKind;
    case Rounds::kMixed:
      return Selection::kMixed;
    case Rounds::kAuto:
      break;
  }
  return asked.has_goal() ? Selection::kByKind : Selection::kMixedOnAngles;
}

PassEffort pass_effort(const Asked& asked) {
  const ImproveOptions& options = asked.options();
  PassEffort pass;
  pass.ops = options.ops;
  pass.smoother = asked.is_compat() ? Smoother::kCandidates : options.smoother;
  pass.selection = selection_of(asked);
  pass.seed = options.seed;
  pass.policy = options.policy;
  pass.ranks_exactly = asked.is_compat();
  if (options.device.kind == DeviceChoice::Kind::kOpenCl) pass.device_from = 0;
  pass.device_only_smooths = options.hybrid;
  if (asked.is_frozen()) pass.promise_of_many = 0.5;
  pass.leaves_early = asked.is_frozen();
  // A cell that is all but flat is best mended by what leaves most.
  pass.first_edge_does = asked.has_goal() && *options.min_dihedral > kPlainGoal;
  return pass;
}

/// `any_cost`: whether the worst angle is raised as far as it goes at the time.
PolishEffort polish_effort(const Asked& asked, bool any_cost) {
  PolishEffort polish;
  polish.iterations = asked.iterations_or(polish.iterations);
  if (asked.is_free()) {
    polish.many = kManyCells;
    polish.least_fewer = 10;
  }
  if (any_cost)
    polish.dig_share = 4;
  else if (asked.is_free())
    polish.dig_share = 32;
  polish.selection = selection_of(asked);
  return polish;
}

ThroughoutEffort throughout_effort(const PolishEffort& polish) {
  ThroughoutEffort effort;
  effort.polish = polish;
  effort.polish.many = kManyCells;
  effort.polish.least_fewer = 50;
  effort.polish.gain = 1.1;
  effort.polish.dig_share = 1;
  effort.polish.seeds_of_vertex = 32;
  return effort;
}

FirstPolish first_polish(const Asked& asked, const PolishEffort& polish) {
  FirstPolish first{.polish = polish};
  // Few cells, so kind by kind, as towards a goal.
  if (asked.options().rounds == Rounds::kAuto) first.polish.selection = Selection::kByKind;
  return first;
}

BulkEffort bulk_effort(const Asked& asked) {
  BulkEffort bulk;
  bulk.metric = asked.options().metric;
  bulk.iterations = asked.iterations_or(bulk.iterations);
  if (bulk.metric == Metric::kVolumeLength) bulk.focus = 0.45;
  bulk.removes_vertices = asked.options().bulk_nodes;
  return bulk;
}

/// With a surface that may change its shape, what many cells suffer from can be mended, too. Beyond kFreeUpTo
/// that is dear on the way; what was left out is looked at in the end.
double largest_share(const Asked& asked, double degrees) {
  constexpr double kUpToThere = 0.35, kBeyond = 0.2;
  if (!asked.is_free()) return kManyShare;
  return degrees > kFreeUpTo ? kBeyond : kUpToThere;
}

TargetEffort target_effort(const Asked& asked) {
  TargetEffort effort;
  const double goal = asked.options().min_dihedral.value_or(kLargestGoal);
  for (double degrees : kTargets) {
    const TargetAngle target{degrees, largest_share(asked, degrees)};
    effort.beyond.push_back(target);
    if (degrees < goal) effort.targets.push_back(target);
  }
  if (asked.has_goal()) effort.targets.push_back({goal, largest_share(asked, goal)});
  // What holds a few cells there is a surface that gave way elsewhere: it says nothing of the others.
  if (asked.is_free()) effort.in_turn_beyond = kLargestGoal;
  return effort;
}

RefineEffort refine_effort(const Asked& asked, std::size_t of_hundred, bool any_cost) {
  RefineEffort refine;
  refine.iterations = asked.iterations_or(refine.iterations);
  refine.of_hundred = of_hundred;
  if (any_cost) {
    refine.gain = 1.3;
    refine.least_share = -1;
    refine.largest_share = std::numeric_limits<double>::infinity();
  } else {
    refine.least_share = 0.08;
    refine.largest_share = 0.6;
  }
  return refine;
}

LastCellsEffort last_cells_effort(const Asked& asked) {
  LastCellsEffort last;
  if (asked.coarsens() || asked.has_goal()) last.up_to = std::numeric_limits<double>::infinity();
  // Where the surface may change its shape there is always something that gives way by little.
  if (asked.is_free()) last.again = kLargeRise;
  const PatchEffort& effort = asked.is_frozen() ? kLittleEffort : kSurfaceEffort;
  if (asked.has_goal() && asked.is_flat()) last.patches_first = {effort};
  last.patches = {effort, kLastEffort};
  if (asked.is_free()) last.patches_up_to = kFreeUpTo;
  return last;
}

GoalEffort goal_effort(const Asked& asked) {
  GoalEffort goal;
  goal.degrees = *asked.options().min_dihedral;
  goal.polish_only = asked.options().polish_only;
  if (asked.limits_iterations()) {
    goal.many_miss = std::numeric_limits<double>::infinity();
    goal.goes_on = false;
  }
  if (asked.coarsens()) goal.many_miss = -1;  // which takes all cells
  return goal;
}

AnyCostEffort any_cost_effort(const Asked& asked, CellBounds bounds) {
  AnyCostEffort effort;
  effort.bounds.min = bounds.min;  // what is left out now is missing for the last cells
  effort.bounds.max = asked.options().max_cells;
  if (effort.bounds.max > 0) {
    effort.most_of_hundred = 0;
  } else if (asked.coarsens() || asked.is_flat()) {
    effort.bounds.max = bounds.max;
    effort.most_of_hundred = 0;
  }
  effort.polish = polish_effort(asked, true);
  effort.targets.assign(kTargetsAtAnyCost.begin(), kTargetsAtAnyCost.end());
  effort.neighbourhoods = asked.coarsens();
  effort.patches.assign(kAllEfforts.begin(), kAllEfforts.end());
  if (asked.is_frozen() && !asked.coarsens()) {
    effort.refine = refine_effort(asked, 90, true);
    effort.refine_again = refine_effort(asked, 96, true);
  }
  return effort;
}

/// But for the strategies of other runs that it goes on with.
Strategy alone(const ImproveOptions& options, const Survey& found, std::size_t n_cells) {
  const Asked asked(options);
  Strategy strategy;
  strategy.course = asked.is_compat()  ? Course::kCompat
                    : asked.has_goal() ? Course::kGoal
                    : asked.any_cost() ? Course::kAnyCost
                                       : Course::kDefault;
  strategy.pass = pass_effort(asked);
  strategy.bounds = bounds_of(asked, n_cells);
  strategy.bounds_asked = {options.min_cells, options.max_cells};
  if (found.n_invalid > 0 && !asked.is_compat()) strategy.untangle.emplace();
  strategy.floor = report_value(Metric::kMinDihedral, std::clamp(found.worst, 0.0, kRegularDihedral));
  // With coarsening, the default run goes as far as it can at once.
  strategy.polish = polish_effort(asked, asked.any_cost() && asked.coarsens());
  strategy.throughout = throughout_effort(strategy.polish);
  strategy.first_polish = first_polish(asked, strategy.polish);
  if (asked.coarsens()) strategy.coarsen.emplace();
  strategy.bulk = bulk_effort(asked);
  strategy.targets = target_effort(asked);
  if (asked.is_frozen()) {
    strategy.refine = refine_effort(asked, 92, false);
    if (!asked.limits_iterations()) strategy.refine_again = refine_effort(asked, kAllButFew, false);
    strategy.throughout.refine = strategy.refine_again;
    if (strategy.throughout.refine)
      strategy.throughout.refine->seeds_of_vertex = strategy.throughout.polish.seeds_of_vertex;
  }
  if (asked.searches()) {
    strategy.neighbourhoods.emplace();
    if (asked.is_free()) strategy.neighbourhoods->few_to_dig = 300;
  }
  strategy.patch.enabled = has(options.ops, Ops::kInsert) && asked.searches();
  strategy.patch.has_surface = asked.is_flat();
  strategy.last_cells = last_cells_effort(asked);
  if (asked.has_goal()) strategy.goal = goal_effort(asked);
  if (asked.any_cost()) strategy.any_cost = any_cost_effort(asked, strategy.bounds);
  if (asked.is_free()) strategy.volume = VolumeEffort{.keeps_angles_only = asked.has_goal()};
  strategy.compat.iterations = asked.iterations_or(strategy.compat.iterations);
  return strategy;
}

}  // namespace

void validate(const ImproveOptions& options) {
  HFR_REQUIRE(!options.min_dihedral || (*options.min_dihedral > 0 && *options.min_dihedral < kLargestGoal),
              "the smallest dihedral asked for must lie between 0 and 70.5 degrees, not " +
                  std::to_string(options.min_dihedral.value_or(0)));
  HFR_REQUIRE(
      !options.min_dihedral || !options.raise_min_dihedral,
      "raise_min_dihedral asks for the largest angle that can be had, min_dihedral for a certain one: "
      "give one of them");
  HFR_REQUIRE(!options.polish_only || options.min_dihedral,
              "polish_only is for runs with a goal: give min_dihedral, too");
  HFR_REQUIRE(
      !options.passes_only || !options.raise_min_dihedral,
      "raise_min_dihedral searches for the last cells, which passes_only leaves out: give one of them");
  HFR_REQUIRE(options.iterations >= 0, "the number of iterations must not be negative");
  HFR_REQUIRE(options.time_limit > 0, "the time limit must be positive");
  HFR_REQUIRE(options.ops != Ops::kNone, "there is no operator to work with");
  HFR_REQUIRE(options.policy.threads >= 1, "the number of threads must be at least 1");
  const SurfaceOptions& surface = options.surface;
  HFR_REQUIRE(
      surface.feature_angle >= 0 && surface.feature_angle <= 180,
      "the feature angle must lie between 0 and 180 degrees, not " + std::to_string(surface.feature_angle));
  HFR_REQUIRE(!surface.hausdorff || *surface.hausdorff >= 0,
              "the distance from the surface must not be negative");
}

Strategy resolve(const ImproveOptions& options, const Survey& found, std::size_t n_cells) {
  const Asked asked(options);
  Strategy strategy = alone(options, found, n_cells);
  const auto towards = [&](double goal) {
    ImproveOptions other = options;
    other.min_dihedral = goal;
    other.raise_min_dihedral = false;
    return std::make_shared<Strategy>(alone(other, found, n_cells));
  };
  const double goal = options.min_dihedral.value_or(kLargestGoal);
  if (strategy.untangle && goal > kPlainGoal) strategy.plain = towards(kPlainGoal);
  if (asked.any_cost() && !asked.coarsens()) {
    ImproveOptions other = options;
    other.raise_min_dihedral = false;
    strategy.usual = std::make_shared<const Strategy>(resolve(other, found, n_cells));
    return strategy;
  }
  if (goal > kPlainGoal && !options.polish_only && !asked.is_compat() && !asked.limits_iterations() &&
      !asked.coarsens()) {
    const auto claimed = towards(std::min(goal, kClaimedGoal));
    if (options.max_cells == 0 && claimed->bounds.max > 0)
      claimed->bounds.max =
          static_cast<std::size_t>(claimed->goal->more_cells * static_cast<double>(n_cells));
    claimed->pass.first_edge_does = false;  // what is left by then is hard
    strategy.claimed = claimed;
  }
  if (!strategy.claimed) return strategy;
  const auto with = [&](auto&& change) {
    ImproveOptions other = options;
    change(other);
    return std::make_shared<const Strategy>(resolve(other, found, n_cells));
  };
  if (asked.is_frozen()) {
    if (!asked.has_goal())
      strategy.towards_claim = with([](ImproveOptions& other) { other.min_dihedral = kClaimedGoal; });
    return strategy;
  }
  if (asked.has_goal()) {
    strategy.without_goal = with([](ImproveOptions& other) { other.min_dihedral.reset(); });
    return strategy;
  }
  strategy.frozen = with([](ImproveOptions& other) { other.surface.mode = SurfaceMode::kFrozen; });
  if (asked.is_free())
    strategy.flat = with([](ImproveOptions& other) { other.surface.mode = SurfaceMode::kFlat; });
  return strategy;
}

Strategy strategy_of_patch(const Strategy& whole) {
  Strategy patch;
  patch.pass.ops = whole.pass.ops;
  patch.pass.seed = whole.pass.seed;
  patch.pass.policy = {};
  const int n_kinds =
      has(patch.pass.ops, Ops::kEdge) + has(patch.pass.ops, Ops::kFace) + has(patch.pass.ops, Ops::kNode);
  patch.pass.selection = n_kinds < 2 ? Selection::kByKind : Selection::kMixedOnAngles;
  if (!whole.patch.has_surface) patch.pass.promise_of_many = 0.5;
  patch.pass.leaves_early = whole.pass.leaves_early;
  patch.polish.iterations = whole.patch.iterations;
  patch.polish.dig_share = 4;  // as many vertices as it takes
  patch.polish.selection = patch.pass.selection;
  return patch;
}

Strategy strategy_to_connect(const Strategy& patch) {
  Strategy connecting = patch;
  connecting.pass.ops = without(without(patch.pass.ops, Ops::kNode), Ops::kInsert);
  const bool both = has(patch.pass.ops, Ops::kEdge) && has(patch.pass.ops, Ops::kFace);
  connecting.pass.selection = both ? Selection::kMixedOnAngles : Selection::kByKind;
  connecting.polish.selection = connecting.pass.selection;
  return connecting;
}

}  // namespace hfr
