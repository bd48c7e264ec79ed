// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_STRATEGY_HH
#define HFR_REMESH_STRATEGY_HH

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Parallel/Parallel.hh"
#include "Quality/Metrics.hh"
#include "Remesh/Improve.hh"
#include "Remesh/Survey.hh"

namespace hfr {

// What a run is going to do, as plain data: resolve() is the only reader of mode, goal, bounds and effort in
// ImproveOptions, and nothing below it asks for them again. docs/pipeline.md has the order of the stages and
// the same numbers. Angles are degrees unless "decision value" is said; see Quality/Metrics.hh. Shares are of
// 1. "Shown by" names the rows in which a change of a stage's numbers shows: runs and surface modes of
// bench/quality_table.py, over all its meshes unless one is named, or a table of docs/.

/// Degrees that can be asked for: a regular tetrahedron has 70.53.
inline constexpr double kLargestGoal = 70.5;
/// A goal that valid cells meet but for those that are all but flat.
inline constexpr double kPlainGoal = 0.001;
/// What a run without a goal claims to reach wherever a run with it as goal does.
inline constexpr double kClaimedGoal = 15;
inline constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

// What several stages go by; docs/ablation.md has a row of each for all of them together.
/// Degrees below which cells are poor: what a run without a goal claims, and works for first.
inline constexpr double kPoorAngle = kClaimedGoal;
/// Degrees up to which vertices are put in where they are missing, and the last cells are searched for.
inline constexpr double kGoodAngle = 30;
/// Shares of the cells: a few, whatever they are like, and so many that the mesh is.
inline constexpr double kFewShare = 0.02, kManyShare = 0.1;
/// One in so many is a few; and of 100, all but a few.
inline constexpr auto kOneInFew = static_cast<std::size_t>(1 / kFewShare);
inline constexpr auto kAllButFew = static_cast<std::size_t>(100 - 100 * kFewShare);
/// Cells so few that whatever may help is tried on each of them.
inline constexpr std::size_t kFewCells = 64;
/// Poor cells so many that it does not count when some of them get better by little.
inline constexpr std::size_t kManyCells = 200;
/// Factor by which a worst decision value or angle has to rise to count as a gain, and where that has to
/// make up for new cells or another search.
inline constexpr double kRise = 1.002, kLargeRise = 1.02;
/// Times the cells that there are which a worst angle below what is claimed, or at any cost, may take.
inline constexpr double kMoreCells = 1.5;
/// Share of a percentile that may be lost for what is claimed, and of the claim that more cells have to
/// bring.
inline constexpr double kClaimShare = 0.03;
/// Iterations of a loop that ends when it brings nothing, at most; and in a row that bring nothing.
inline constexpr int kIterations = 60, kIdle = 2;

/// Numbers of cells that a mesh may come to have. Vertex collapse keeps to `min`, insertion to `max`; swaps
/// may add or take a few. 0: no bound. Shown by docs/worst-angles.md, "How many cells come out".
struct CellBounds {
  std::size_t min = 0;
  std::size_t max = 0;

  /// Cells that a round may take from a mesh of n_cells, as RoundOptions has it.
  std::size_t may_lose(std::size_t n_cells) const {
    return min > 0 ? n_cells - std::min(n_cells, min) : kNoLimit;
  }
  /// Cells that a round may add to one.
  std::size_t may_gain(std::size_t n_cells) const {
    return max > 0 ? max - std::min(n_cells, max) : kNoLimit;
  }
};

/// A Remesher's own numbers; its repairs are runs as others. Shown by bench/remesher.cc and
/// examples/turning_body.cc.
struct StepEffort {
  /// A cell that a repair had to leave below the trigger calls for another one once its decision value, a
  /// sin², has fallen below this share: 2 % of its angle.
  double much_worse = 0.96;
  int halvings = 6;  ///< by which the largest safe part of a displacement is looked for: to 1/64 of it
  /// Cells that the mesh is held to, of 100 that it had, where the caller gives no bounds: those of a run
  /// alone let the turning body lose a third of its cells in 40 steps.
  std::size_t fewest_of_hundred = 82, most_of_hundred = 118;

  /// Than the value that a repair has left, which may be that of an inverted cell.
  bool is_much_worse(double value, double left) const {
    return value < (left > 0 ? much_worse * left : left / much_worse);
  }
  /// The bounds where the caller gives none.
  void bound(ImproveOptions& options, std::size_t n_cells) const {
    if (options.min_cells == 0) options.min_cells = n_cells * fewest_of_hundred / 100;
    if (options.max_cells == 0) options.max_cells = (n_cells * most_of_hundred + 99) / 100;
  }
};
inline constexpr StepEffort kStepEffort;

/// Whether edge removal, face swap and vertex collapse run in turn or compete in one selection.
enum class Selection {
  kByKind,
  kMixedOnAngles,  ///< compete where the metric of the stage measures dihedral angles
  kMixed,
};

/// What every pass of a run needs to know, and how long it goes on. Shown by --runs default, worst angle
/// and seconds.
struct PassEffort {
  Ops ops = Ops::kDefault;
  Smoother smoother = Smoother::kNewton;
  Selection selection = Selection::kMixedOnAngles;
  std::uint64_t seed = 1;
  par::Policy policy;
  bool ranks_exactly = false;  ///< by the exact worst cell, as the paper does (docs/paper-tables.md)
  /// Cells from which passes run on a device, where there is one: a smaller mesh is done before a copy of it
  /// would be (bench/device.sh).
  std::size_t device_from = 50'000;
  bool device_only_smooths = false;
  /// Where more cells than few_seeds are poor, the edges of each are looked at from the longest on until the
  /// removal of one mends it: towards a goal half to four fifths need not be looked at. Otherwise, and for
  /// the last ones, all of them, and the best for the cells round it wins.
  bool first_edge_does = false;
  int rounds = 12;           ///< of one operator in one pass, at most
  std::size_t little = 200;  ///< a pass ends with a round that commits less than 1/little of its first one
  /// Factor by which a new vertex or a searched cluster has to raise the worst decision value.
  double least_gain = kLargeRise;
  int insert_rounds = 200;          ///< of insertion, which takes seeds that lie apart
  std::size_t cells_of_vertex = 4;  ///< that a new one takes, about
  std::size_t search_points = 14;   ///< points of a cavity whose fillings are searched (ClusterSearch)
  std::size_t search_nodes = 300;   ///< of each search: more found little more on the test meshes
  /// Where more cells than this wait for a vertex, only the most promising sites are followed up for each:
  /// `sites_of_many` find the same as all on the test meshes, in half the time; for the last ones each
  /// counts.
  std::size_t few_seeds = kFewCells;
  std::size_t sites_of_many = 3;
  /// Least promise of such a site; see VertexInsertion::least_promise. With a frozen surface nearly half of
  /// the cells have no site of more, and one in twelve of these a plan.
  double promise_of_many = 0;
  /// VertexInsertion::leaves_early: not in flat and free, where vertices that take long are missed.
  bool leaves_early = false;
  /// Where so many vertices of a curved surface are looked at, or one in `many_moves_share` of the mesh, the
  /// worst cell of a star has to rise by `move_gain` for its vertex to move: moves cost far more there than
  /// inside, and each calls for others.
  std::size_t many_moves = 300;
  std::size_t many_moves_share = 8;
  double move_gain = 1.05;
};

/// Mending inverted and flat cells. Shown by bench/untangle.py and docs/untangling.md, "Measured".
struct UntangleEffort {
  int first_sweeps =
      6;  ///< visits to each vertex of one layer round the invalid cells, before more layers are tried
  int patience = 4;      ///< sweeps that bring nothing
  double still = 1e-3;   ///< share of its first moves to which those of a relaxation have to come down
  int newton_steps = 3;  ///< at a vertex
  /// Decision values of volume-length, from what is all but flat to what is merely poor: cells below one are
  /// worked on, below the next only when that has stopped helping.
  std::array<double, 4> focus = {1e-4, 1e-2, 0.1, 0.3};
  int iterations = kIterations;  ///< at all of them together
  int idle = kIdle;  ///< iterations without fewer invalid cells or a better worst one, and widths that bring
                     ///< nothing
};

/// All cells in one metric. Shown by --runs default, percentiles and seconds, the cavities first;
/// `removes_vertices` by docs/worst-angles.md, "Vertex collapse in the bulk stage".
struct BulkEffort {
  Metric metric = Metric::kVolumeLength;
  int iterations = 3;
  /// Cells whose decision value is below are worked on. For volume-length 0.45 (q = 0.67): working on all
  /// cells of the 609,574-cell cavity raises the 1st percentile of the smallest dihedrals by 0.1 degrees more
  /// and takes half as long again.
  double focus = std::numeric_limits<double>::infinity();
  bool removes_vertices = false;
};

/// Removal of vertices wherever it helps. Shown by docs/surface.md, "--coarsen".
struct CoarsenEffort {
  double below = 50;             ///< degrees; cells that are worked on
  int iterations = kIterations;  ///< at most
  double still = 1 - kFewShare;  ///< share of an iteration's cells that may be left for another one
};

/// Work on cells with an angle below a target. Shown by --runs default,max with --surface frozen,flat,free;
/// the search by docs/worst-angles.md, "Cluster search".
struct PolishEffort {
  int iterations = kIterations;  ///< at most
  /// An iteration that neither lowers the number of poor cells nor raises the worst decision value by `gain`
  /// (see Rise.hh) is idle; after `idle` of them in a row dearer operators are asked.
  double gain = 1.01;
  int idle = kIdle;
  /// With more poor cells than may get vertices, or than `many`, an iteration is idle unless it mends one in
  /// `least_fewer` of those beyond: there is always something that gets better by little, and what is dearer
  /// does more. Shown by the steps of bench/moving_body.py, seconds.
  std::size_t many = kNoLimit;
  std::size_t least_fewer = 20;
  /// FanMerge counts as gain where it merges one in so many of these: each merger takes several cells.
  std::size_t fan_of = 4;
  /// Poor cells up to which vertices are inserted for them, and clusters searched: `few_to_dig`, or one cell
  /// in `dig_share`.
  std::size_t few_to_dig = 50;
  std::size_t dig_share = 48;
  /// Insertion for more than PassEffort::few_seeds cells ends after a round in which fewer than one in so
  /// many got a vertex.
  std::size_t seeds_of_vertex = kNoLimit;
  /// Tenths of the poor cells of the last insertion that may be left for the next one, unless the worst has
  /// risen: more vertices would only fill the place with poor cells.
  std::size_t dig_again_tenths = 9;
  Selection selection = Selection::kMixedOnAngles;
};

/// The worst angles before the bulk stage, which knows only volume-length and can box them in. Shown by
/// --runs default, worst angle.
struct FirstPolish {
  PolishEffort polish;
  double target = kPoorAngle;         ///< degrees
  double largest_share = kManyShare;  ///< of cells below it; where there are more, the bulk stage comes first
};

/// An angle that the worst cells are raised to.
struct TargetAngle {
  double degrees;
  /// Where a larger share of the cells lies below a target, vertices have to be put in for many, and each
  /// target has to bring enough; with a surface that may change it is left out until the end of the run.
  double largest_share = 1;
  /// Left out where the worst is below this angle: for meshes that end far below, one more in vain.
  double from = 0;
};

/// Raising the worst cells from target to target. Shown by --runs default, worst angle and seconds.
struct TargetEffort {
  std::vector<TargetAngle> targets;  ///< ascending; the last is the goal where one was asked for
  std::vector<TargetAngle> beyond;   ///< all of them: work for more makes room that a goal's last cells lack
  /// Beyond what most meshes come to, a target is tried only when the one before was reached.
  double in_turn_beyond = 25;
  /// Where more cells than TargetAngle::largest_share miss a target, it is tried only after one that has left
  /// less than this share of the cells that missed it.
  double enough_left = 0.5;
  /// With a surface that may change, the targets below one that was left out which a few cells may miss for
  /// it to be worked for in the end, beyond what is claimed. Where they miss more, work for the many raises
  /// percentiles alone, at nearly the price of the run: gaia_dog, free, the 1st one from 28.8 to 33.0 in 1.9
  /// times the time.
  std::size_t may_be_missed = 1;
};

/// New vertices where the mesh lacks them. Shown by --runs default, percentiles and cells; `gain` by
/// docs/operators.md, "Insertion" and its row of ipc_dolphin5k.
struct RefineEffort {
  double below = kGoodAngle;  ///< degrees; cells that vertices are put in for
  double least_share = 0;     ///< of cells below that show that vertices are missing
  double largest_share = 1;   ///< beyond which the mesh is poor throughout, and vertices would not mend it
  double gain = 1.6;          ///< factor by which a vertex raises sin² of the worst of its cells
  /// Of 100 cells that the run may make, those there may be afterwards; the rest is for the worst cells.
  std::size_t of_hundred = 100;
  /// Times the cells that there are, where the run has no bound on them: cells that no vertex mends let the
  /// poor ones become more and more.
  double more_cells = kMoreCells;
  int iterations = kIterations;  ///< at most
  /// Vertices go in when an iteration leaves more than this share of the poor cells,
  double fewer = 1 - kFewShare;
  std::size_t one_in = kOneInFew;          ///< and no more once fewer than one in so many of these got one
  std::size_t seeds_of_vertex = kNoLimit;  ///< as in PolishEffort
};

/// Raising the worst angle of a mesh that is poor throughout. Each iteration goes over much of the mesh
/// there, so it has to bring something for its work, in cells mended or in the worst angle; vertices go to
/// the worst cells first, and to as many as get one.
struct ThroughoutEffort {
  PolishEffort polish;
  double below = kPoorAngle;     ///< degrees; a mesh is poor throughout where a larger share of its cells
  double share = kManyShare;     ///< is below, or where no larger share of its vertices may move
  double dig_share = kFewShare;  ///< of the cells that miss a target, from which it is worked for in this way
  std::optional<RefineEffort> refine;   ///< in the place of refine_again, without a first one
  std::size_t of_hundred = kAllButFew;  ///< cells that there may be; the rest is for the last ones
};

/// Work on the surroundings of a few cells that miss an angle by little, as if the angle were larger: that
/// makes room. Shown by --runs default, worst angle.
struct NeighbourhoodEffort {
  struct Try {
    int layers;      ///< of cells round them
    double degrees;  ///< that the angle is larger
  };
  std::array<Try, 4> tries = {{{2, 2.5}, {2, 5}, {4, 2.5}, {4, 5}}};
  std::size_t few = 12;  ///< cells at most
  int iterations = 4;    ///< of each try
  /// Poor cells up to which vertices are inserted: where the surface may change its shape and there are more,
  /// those that are put in for the sake of room go to the wrong places, at most of the cost.
  std::size_t few_to_dig = kNoLimit;
};

/// Ways there are to put an apex over each needle of a patch at once.
inline constexpr std::size_t kNeedleRows = 2;

/// Tries on copies of the surroundings of the worst cells: "insertion followed by smoothing and topological
/// improvement", kept or rolled back as one step (Klingner & Shewchuk 2007). Shown by --runs default,max,
/// worst angle and seconds, ipc_dolphin5k for rows over needles; docs/operators.md, "Patches".
struct PatchEffort {
  std::size_t few = kFewCells;     ///< cells below the next angle; where there are more, nothing is tried
  int layers = 3;                  ///< of cells round the worst one
  std::size_t patches = 4;         ///< at a time
  int turns = kIterations;         ///< at most
  std::size_t rows = kNeedleRows;  ///< of apexes over needles that are tried
  std::size_t vertices = 8;        ///< new ones for one patch, each in a try of its own
  std::size_t removals = 12;       ///< vertices next to the worst cell that are taken out instead
  bool replaces = false;           ///< puts a new one in for each that is taken out, at several places
  double degrees = 0.6;            ///< beyond the worst angle, that are worked for in a turn
};
/// Where the surface is frozen, and nobody asked for more.
inline constexpr PatchEffort kLittleEffort = {};
/// Where the surface may change, which has cheaper ways to mend needles, but for the very last cells.
inline constexpr PatchEffort kSurfaceEffort = {.turns = 4, .rows = 0};
/// For the very last cells.
inline constexpr PatchEffort kLastEffort = {
    .few = 6, .layers = 2, .turns = 2, .vertices = 20, .removals = 30};
/// One after the other, where the worst angle is to be raised at any cost: what one cannot mend, another may.
inline constexpr std::array<PatchEffort, 3> kAllEfforts = {
    {{.patches = 8, .vertices = 20, .removals = 20, .replaces = true, .degrees = 2},
     {.layers = 4, .patches = 8, .vertices = 20, .removals = 20, .replaces = true, .degrees = 0.5},
     {.layers = 2, .patches = 8, .vertices = 20, .removals = 20, .replaces = true, .degrees = 3}}};

/// What holds for each try on a patch.
struct PatchTrial {
  bool enabled = true;  ///< not without insertion, nor where iterations are limited
  double rise = kRise;  ///< times sin² of the worst cell of a patch: less is not worth its cells
  double ahead = 1.05;  ///< times the target, which is worked for
  int iterations = 8;   ///< of the polish of one try: more found no more
  /// Where over each needle an apex of its own is put, as a share of the way from the short side to the tip,
  /// one try each, and how high, as a share of what would be best for a lone one; see detail::Needle.
  std::array<double, kNeedleRows> row_shares = {0.37, 1.0 / 3.0};
  double row_height = 0.8;
  double slender = 0.35;  ///< short side over length of a needle, at most
  bool has_surface =
      false;  ///< whether the patch's part of the surface may change, too: flat ones may, while
              ///< a curved one is held to the shape of the input, which a patch does not know
};

/// The last few cells below a target. Shown by --runs default,20,30, worst angle and seconds.
struct LastCellsEffort {
  double up_to = kGoodAngle;  ///< degrees; targets beyond are left unless a goal was asked for
  double again = kRise;  ///< factor by which the worst angle has to rise for neighbourhoods to be tried again
  double rise = kRise;   ///< and for the stage to say that it has
  /// Patches that are searched before the neighbourhoods: the surroundings of a flat surface take vertices
  /// wherever they may; towards a goal patches need fewer.
  std::vector<PatchEffort> patches_first;
  std::vector<PatchEffort> patches;  ///< that are searched after them
  /// Degrees up to which they are: where the surface may change its shape, which patches do not know, there
  /// are cheaper ways beyond.
  double patches_up_to = std::numeric_limits<double>::infinity();
};

/// An angle that was asked for. Shown by --runs 15,25 with --surface frozen,flat,free.
struct GoalEffort {
  double degrees = 0;
  /// Where a larger share of the cells misses it, all cells are worked on before it is worked for: most would
  /// be touched anyway, and polished by themselves they would lose too many vertices.
  double many_miss = 0.2;
  /// Where no larger share is left in the end, a frozen surface holds them, whatever is done to others; and
  /// where no larger one is far below the others, these cells keep the worst angle down, and no target that
  /// was left out for many.
  double few_miss = 0.01;
  bool polish_only = false;  ///< nothing but the polish, whatever it leaves
  bool goes_on = true;       ///< with all cells where the goal was missed; not where iterations are limited
  /// Share of its 1st and 5th percentile that a default run may lose for what it claims.
  double may_fall = kClaimShare;
  /// Times the cells of the input that it may make for that; so many times again, `turns` in all, while the
  /// worst angle rises by `pays`, a share of the goal: a share of itself would be nothing where it is all but
  /// 0. Or while it would rise with as many as come in all; and where these leave no room for a vertex. Also
  /// for cells that others have kept from their turn, while some are mended.
  double more_cells = kMoreCells;
  int turns = 3;
  double pays = kClaimShare;
};

/// The worst angle as far as it goes, whatever it costs in time: after a default run. Shown by --runs max.
struct AnyCostEffort {
  CellBounds bounds;
  /// Of 100 cells that the default run leaves, those that there may be; 0: as bounds say. With a surface
  /// whose facets stay planar it needs no more than otherwise; with one that may change its shape, a single
  /// cell that nothing mends would draw vertices without end: 20 cells came to 14,842 in 12 s.
  std::size_t most_of_hundred = static_cast<std::size_t>(100 * kMoreCells);
  PolishEffort polish;
  std::vector<TargetAngle> targets;
  int missed = 4;               ///< targets in a row that may be missed
  double gain = kRise;          ///< factor of the worst angle that makes a target no miss
  double fewer = 0.8;           ///< share of the cells below it that may be left, for the same
  double again = kLargeRise;    ///< factor by which a search of the worst cells starts the climb anew
  double may_fall = kFewShare;  ///< share of the 1st and 5th percentile that may be lost
  bool neighbourhoods = false;  ///< improved at each target, and not only at the last
  std::vector<PatchEffort> patches;
  std::optional<RefineEffort> refine, refine_again;
};

/// The enclosed volume, given back at the end. Shown by docs/surface.md, "Measured", column volume.
struct VolumeEffort {
  bool keeps_angles_only =
      false;  ///< judges by dihedral angles, so that a goal is not lost for an obtuse one
  int passes = 8;
  double enough = 5e-5;  ///< of the volume
};

/// A surface without cells, from all its triangles to the worst ones; see improve_triangles(). Shown by
/// docs/surface.md, "A surface without cells".
struct TriangleEffort {
  int bulk_iterations = 4;  ///< at most, over all triangles
  double enough = 0.01;     ///< of the triangles: a bulk iteration that changes fewer is the last one
  /// Degrees that the worst triangles are raised to where no goal was asked for, in turn.
  std::array<double, 8> targets = {2, 5, 10, 15, 20, 25, 30, 35};
  /// Where a larger share of the triangles lies below a target that nobody asked for, the mesh as a whole is
  /// beyond it.
  double largest_share = 0.25;
  int iterations = kIterations;  ///< of one target, at most
  /// Iterations in a row without fewer poor triangles after which edges are split; after twice as many
  /// nothing more is tried.
  int idle = kIdle;
  VolumeEffort volume;  ///< by which the enclosed volume is given back
  /// Times the worst decision value: a vertex that moves leaves no triangle below it poorer than it was.
  double volume_focus = 1.1;
};

/// The paper's pipeline. Shown by bench/paper_tables.py and docs/paper-tables.md.
struct CompatEffort {
  int iterations = 3;  ///< "three were enough to eliminate all inverted elements"
};

enum class Course { kDefault, kGoal, kAnyCost, kCompat };

/// Everything that shapes the result of a run. Stages that are not to run are empty.
struct Strategy {
  Course course = Course::kDefault;
  PassEffort pass;
  CellBounds bounds;        ///< that the run keeps to first
  CellBounds bounds_asked;  ///< those of the options alone; for a goal that is missed within the others
  std::optional<UntangleEffort> untangle;
  /// Degrees where the worst angle of the input stands: the bulk stage may take cells below it, which are
  /// mended first.
  double floor = 0;
  FirstPolish first_polish;
  std::optional<CoarsenEffort> coarsen;
  BulkEffort bulk;
  PolishEffort polish;
  ThroughoutEffort throughout;
  TargetEffort targets;
  std::optional<RefineEffort> refine, refine_again;
  std::optional<NeighbourhoodEffort> neighbourhoods;
  PatchTrial patch;
  LastCellsEffort last_cells;
  std::optional<GoalEffort> goal;
  std::optional<AnyCostEffort> any_cost;
  std::optional<VolumeEffort> volume;
  CompatEffort compat;
  /// Where the input has invalid cells and more is asked for than that they be mended: the strategy of a run
  /// that only mends them (kPlainGoal), which is done first.
  std::shared_ptr<const Strategy> plain;
  /// At any cost: that of the default run, with which it begins.
  std::shared_ptr<const Strategy> usual;
  /// That of kClaimedGoal, or of the goal where that is smaller, for what is left below it.
  std::shared_ptr<const Strategy> claimed;
  /// With a frozen surface and no goal, for what is left below that of `claimed`: that of the run which is
  /// asked for it. Shown by bench/claim.py.
  std::shared_ptr<const Strategy> towards_claim;
  /// Where the surface may change, for what is left below the goal of `claimed`: that of the run without a
  /// goal, or without one that of the run with a frozen surface, and where it may change its shape, of the
  /// run with a flat one.
  std::shared_ptr<const Strategy> without_goal, frozen, flat;

  /// For cells that have fallen below a worst angle that there was, the input's or another: any gain counts,
  /// for they are few, and moves bring most of them back by little at a time.
  PolishEffort mending() const {
    PolishEffort effort = any_cost ? any_cost->polish : polish;
    effort.gain = 1;
    return effort;
  }
};

/// Throws InvalidInput for options out of range.
void validate(const ImproveOptions& options);
/// The strategy of a run over a mesh of n_cells in which survey() has found that.
Strategy resolve(const ImproveOptions& options, const Survey& found, std::size_t n_cells);
/// That of a try on a copy of a patch, which runs beside others on one thread.
Strategy strategy_of_patch(const Strategy& whole);
/// That of connecting vertices that have come to a patch all at once: neither removes nor inserts any.
Strategy strategy_to_connect(const Strategy& patch);

}  // namespace hfr

#endif
