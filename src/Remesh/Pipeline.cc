// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Pipeline.hh"

#include <algorithm>

#include "HalfFace/Layers.hh"
#include "Remesh/Stage.hh"

namespace hfr {
namespace {

constexpr int kDefaultBulkIterations = 3;
/// Volume-length above which the bulk stage leaves a cell alone, as decision value (q = 0.67). Measured on
/// the 609,574-cell cavity: working on all cells raises the 1 % percentile of the smallest dihedrals by 0.1
/// degrees more and takes half as long again.
constexpr double kBulkFocus = 0.45;
constexpr int kMaxPolishIterations = 60;
/// A polish iteration that neither lowers the number of poor cells nor raises the worst by this factor is
/// idle.
constexpr double kPolishGain = 1.01;
constexpr int kMaxIdle = 2;
/// Where the shape of the surface may change there is always something that gets better by little. An
/// iteration on more than so many poor cells is idle there unless it mends one in so many.
constexpr std::size_t kManyPoor = 200;
constexpr std::size_t kLeastFewer = 10;
// Cells that the polish may insert vertices for: at most so many, or one in so many.
constexpr std::size_t kFewPoor = 50;
constexpr std::size_t kPoorShare = 48;
constexpr std::size_t kPoorShareCurved = 32;    // where the shape of the surface may change
constexpr std::size_t kPoorShareAtAnyCost = 4;  // where the worst angle is to be raised as far as it goes
/// Cells whose surroundings are searched at most where nobody asked for an angle.
constexpr std::size_t kFewToSearch = 100;

// While vertices are removed: the cells that are worked on, and how many of 1 may be left of an iteration's
// for another one.
constexpr double kCoarsenBelow = 50;  // degrees
constexpr int kMaxCoarsenings = 20;
constexpr double kStillCoarsens = 0.98;

/// What has run for cells that miss an angle by little: so many layers of cells round them are worked on as
/// if the angle were larger, which makes room.
struct Relief {
  int layers;
  double degrees;
};
constexpr std::array<Relief, 4> kReliefs = {{{2, 2.5}, {2, 5}, {4, 2.5}, {4, 5}}};
constexpr std::size_t kFewToRelieve = 12;
constexpr int kReliefIterations = 4;
constexpr double kLargestRelief = 60;  // degrees
/// Where the surface may change its shape and more cells than this are poor, vertices that are put in for the
/// sake of room go to the wrong places, at most of the cost.
constexpr std::size_t kFewToDigForRoom = 300;

// Vertices are put in when an iteration leaves more than this share of the poor cells, and no more once
// fewer than one in so many of these got one.
constexpr double kRefineFewer = 0.98;
constexpr std::size_t kRefineLittle = 50;

/// Up to how many poor cells an expensive operator is worth it.
struct Few {
  std::size_t to_dig = 0;
  std::size_t to_search = 0;
};

bool is_invalid(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  return orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) <= 0;
}

double min_dihedral_of(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  return MinDihedral{}(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
}

/// Calls f with a metric functor that the operators are instantiated for.
template <class F>
void with_stage_metric(Metric metric, F&& f) {
  switch (metric) {
    case Metric::kVolumeLength:
    case Metric::kMeanRatio:  // the same order of cells
      return f(VolumeLength{});
    case Metric::kMinSine:
      return f(MinSine2{});
    case Metric::kMinDihedral:
      return f(MinDihedral{});
    default:
      return f(
          CustomMetric([metric](Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return quality(metric, a, b, c, d); }));
  }
}

/// Iterates on cells below `goal` while it helps. Returns true when there are none any more.
template <class Metric>
bool polish_in(Stage<Metric>& stage, const ImproveOptions& options, RunControl& control, double goal,
               const Few& few) {
  const int limit = options.iterations > 0 ? options.iterations : kMaxPolishIterations;
  const bool curved = control.surface() && options.surface.mode == SurfaceMode::kFree;
  std::size_t n_poor = stage.n_below(goal);
  double worst = stage.worst();
  int idle = 0;
  bool has_dug = false;
  std::size_t n_poor_dug = 0;  // when vertices were last inserted
  double worst_dug = 0;
  for (int i = 1; i <= limit && n_poor > 0 && !control.stopped(); ++i) {
    const std::size_t changes = stage.iterate(i, Focus{goal}, true);
    const std::size_t n_poor_now = stage.n_below(goal);
    const double enough = worst > 0 ? worst * kPolishGain : worst;
    const std::size_t at_least = curved && n_poor > kManyPoor ? n_poor / kLeastFewer : 0;
    const bool fewer = n_poor_now + at_least < n_poor;
    idle = fewer || stage.worst() > enough ? 0 : idle + 1;
    n_poor = n_poor_now;
    worst = stage.worst();
    if (n_poor == 0 || (changes > 0 && idle < kMaxIdle)) continue;
    if (has(options.ops, Ops::kEdge) && stage.fan_pass(i, Focus{goal}) > 0) {
      idle = kMaxIdle - 1;
      continue;
    }
    // Cells that nothing else mends, such as those between two faces of a frozen corner, get a vertex. Where
    // the last ones have not paid, more of them would only fill the place with poor cells.
    const bool pays = !has_dug || 10 * n_poor <= 9 * n_poor_dug || worst > worst_dug * kPolishGain;
    if (n_poor <= few.to_dig && has(options.ops, Ops::kInsert) && pays) {
      has_dug = true;
      n_poor_dug = n_poor;
      worst_dug = worst;
      if (stage.insert_pass(i, Focus{goal}) > 0) {
        idle = kMaxIdle - 1;
        continue;
      }
    }
    if (n_poor > few.to_search || !has(options.ops, Ops::kCluster)) break;
    if (stage.cluster_pass(i, Focus{goal}) == 0) break;
    idle = kMaxIdle - 1;
  }
  return n_poor == 0;
}

std::vector<CellHandle> cells_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  const double goal = dihedral_decision(degrees);
  std::vector<CellHandle> cells;
  for (Index i : par::compact<Index>(policy, mesh.n_cells(), [&](std::size_t c) {
         return !mesh.is_deleted(CellHandle(c)) && min_dihedral_of(mesh, CellHandle(c)) < goal;
       }))
    cells.push_back(CellHandle(i));
  return cells;
}

}  // namespace

Survey survey(const TetMesh& mesh, par::Policy policy) {
  const std::size_t n = mesh.n_cells();
  const int n_parts = par::thread_count(policy, n);
  std::vector<Survey> found(static_cast<std::size_t>(n_parts));
  par::parts(n_parts, [&](int part) {
    Survey mine{std::numeric_limits<double>::infinity(), 0};
    // The smallest sine is the cheaper form and never above the smallest dihedral's, which therefore only
    // cells that may set a new record are asked for.
    for_decisions(mesh, MinSine2{}, par::part_begin(n, n_parts, part), par::part_begin(n, n_parts, part + 1),
                  [&](std::size_t i, double value) {
                    if (value < mine.worst)
                      mine.worst = std::min(mine.worst, min_dihedral_of(mesh, CellHandle(i)));
                    if (!(value > 0) && is_invalid(mesh, CellHandle(i))) ++mine.n_invalid;
                  });
    found[static_cast<std::size_t>(part)] = mine;
  });
  Survey all{std::numeric_limits<double>::infinity(), 0};
  for (const Survey& part : found) {
    all.worst = std::min(all.worst, part.worst);
    all.n_invalid += part.n_invalid;
  }
  return all;
}

double smallest_dihedral(const TetMesh& mesh, par::Policy policy) {
  return report_value(Metric::kMinDihedral, std::min(survey(mesh, policy).worst, 8.0 / 9.0));
}

std::size_t n_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  const double goal = dihedral_decision(degrees);
  return par::reduce(
      policy, mesh.n_cells(), std::size_t{0},
      [&](std::size_t i) -> std::size_t {
        return !mesh.is_deleted(CellHandle(i)) && min_dihedral_of(mesh, CellHandle(i)) < goal ? 1 : 0;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

std::vector<CellHandle> invalid_cells(const TetMesh& mesh, par::Policy policy) {
  const auto indices = par::compact<Index>(policy, mesh.n_cells(), [&](std::size_t i) {
    return !mesh.is_deleted(CellHandle(i)) && is_invalid(mesh, CellHandle(i));
  });
  std::vector<CellHandle> cells;
  cells.reserve(indices.size());
  for (Index i : indices) cells.push_back(CellHandle(i));
  return cells;
}

void improve_bulk(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control) {
  const int limit = options.iterations > 0 ? options.iterations : kDefaultBulkIterations;
  with_stage_metric(options.metric, [&](auto metric) {
    Stage<decltype(metric)> stage(mesh, work, options, control, metric, "bulk");
    const Focus focus{options.metric == Metric::kVolumeLength ? kBulkFocus : Focus{}.below};
    for (int i = 1; i <= limit && !control.stopped(); ++i) {
      if (stage.iterate(i, focus, options.bulk_nodes) == 0) break;
      control.set_fraction(0.1 + 0.4 * i / limit);
    }
    stage.to_host();
  });
}

void coarsen(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control) {
  Stage<MinSine2> stage(mesh, work, options, control, MinSine2{}, "coarsen");
  const Focus focus{dihedral_decision(kCoarsenBelow)};
  for (int i = 1; i <= kMaxCoarsenings && !control.stopped(); ++i) {
    const auto n_before = static_cast<double>(mesh.n_logical_cells());
    if (stage.iterate(i, focus, true) == 0) break;
    if (static_cast<double>(mesh.n_logical_cells()) > kStillCoarsens * n_before) break;
  }
  stage.to_host();
}

void restore_volume(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control) {
  if (!control.surface() || options.surface.mode != SurfaceMode::kFree) return;
  // A goal that is met must not be lost for an obtuse angle that is worse.
  if (options.min_dihedral)
    Stage<MinDihedral>(mesh, work, options, control, MinDihedral{}, "volume").restore_volume();
  else
    Stage<MinSine2>(mesh, work, options, control, MinSine2{}, "volume").restore_volume();
}

void refine(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control, double goal,
            double gain) {
  const Focus focus{dihedral_decision(goal)};
  Stage<MinSine2> stage(mesh, work, options, control, MinSine2{}, "refine");
  std::size_t n_poor = stage.n_below(focus.below);
  const int limit = options.iterations > 0 ? options.iterations : kMaxPolishIterations;
  for (int i = 1; i <= limit && n_poor > 0 && !control.stopped(); ++i) {
    stage.iterate(i, focus, false);
    const std::size_t n_left = stage.n_below(focus.below);
    const bool helps = static_cast<double>(n_left) < kRefineFewer * static_cast<double>(n_poor);
    n_poor = n_left;
    if (helps) continue;
    if (!has(options.ops, Ops::kInsert) || stage.insert_pass(i, focus, gain) * kRefineLittle <= n_poor)
      return;
  }
}

std::vector<CellHandle> worst_cells_below(const TetMesh& mesh, double degrees, std::size_t n,
                                          par::Policy policy) {
  std::vector<std::pair<double, CellHandle>> ranked;
  for (CellHandle c : cells_below(mesh, degrees, policy)) ranked.emplace_back(min_dihedral_of(mesh, c), c);
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(std::min(n, ranked.size()));
  std::partial_sort(ranked.begin(), end, ranked.end());
  std::vector<CellHandle> cells;
  for (auto at = ranked.begin(); at != end; ++at) cells.push_back(at->second);
  return cells;
}

double few_below(const TetMesh& mesh, double degrees, par::Policy policy) {
  const auto worst = worst_cells_below(mesh, degrees, kFewToRelieve + 1, policy);
  if (worst.size() <= kFewToRelieve) return degrees;
  return report_value(Metric::kMinDihedral, min_dihedral_of(mesh, worst.back()));
}

bool relieve(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
             double goal) {
  const double decision = dihedral_decision(goal);
  if (options.iterations > 0) return false;  // it would be further ones
  const Few few{.to_dig = kFewToRelieve, .to_search = kFewToRelieve};
  for (const Relief& relief : kReliefs) {
    const std::vector<CellHandle> stuck = cells_below(mesh, goal, options.policy);
    if (stuck.empty()) return true;
    if (stuck.size() > kFewToRelieve || control.stopped()) return false;
    const auto around = vertices_within(mesh, stuck, relief.layers);
    Stage<MinSine2> stage(mesh, work, options, control, MinSine2{}, "relief");
    const Focus focus{dihedral_decision(std::min(goal + relief.degrees, kLargestRelief)), around};
    for (int i = 1; i <= kReliefIterations && !control.stopped(); ++i) {
      std::size_t changes = stage.iterate(i, focus, true);
      if (has(options.ops, Ops::kEdge)) changes += stage.fan_pass(i, focus);
      if (has(options.ops, Ops::kInsert) &&
          (!is_free(options) || stage.n_below(focus.below) <= kFewToDigForRoom))
        changes += stage.insert_pass(i, focus);
      if (changes == 0) break;
    }
    stage.look_again();
    polish_in(stage, options, control, decision, few);
  }
  return cells_below(mesh, goal, options.policy).empty();
}

bool polish(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control, double goal,
            double largest_share) {
  return polish_to(mesh, work, options, control, dihedral_decision(goal), largest_share);
}

bool polish_to(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control,
               double decision, double largest_share) {
  const std::size_t share = options.raise_min_dihedral                   ? kPoorShareAtAnyCost
                            : options.surface.mode == SurfaceMode::kFree ? kPoorShareCurved
                                                                         : kPoorShare;
  Few few;
  few.to_dig = std::max(kFewPoor, mesh.n_logical_cells() / share);
  few.to_search = options.min_dihedral || options.raise_min_dihedral ? few.to_dig : kFewToSearch;
  {
    Stage<MinSine2> stage(mesh, work, options, control, MinSine2{}, "polish");
    const auto n_poor = static_cast<double>(stage.n_below(decision));
    if (n_poor > largest_share * static_cast<double>(mesh.n_logical_cells())) return false;
    if (polish_in(stage, options, control, decision, few)) return true;
  }
  // What is left may be obtuse only, or give way once obtuse angles do not count.
  Stage<MinDihedral> stage(mesh, work, options, control, MinDihedral{}, "finish");
  return polish_in(stage, options, control, decision, few);
}

}  // namespace hfr
