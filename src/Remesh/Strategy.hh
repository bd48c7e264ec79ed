// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_STRATEGY_HH
#define HFR_REMESH_STRATEGY_HH

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
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
// 1. bench/quality_table.py makes the table by which the numbers were chosen; a row that shows what one buys
// is named with it.

/// Degrees that can be asked for: a regular tetrahedron has 70.53.
inline constexpr double kLargestGoal = 70.5;
inline constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

/// Numbers of cells that a mesh may come to have. Vertex collapse keeps to `min`, insertion to `max`; swaps
/// may add or take a few. 0: no bound.
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

/// Whether edge removal, face swap and vertex collapse run in turn or compete in one selection.
enum class Selection {
  kByKind,
  kMixedOnAngles,  ///< compete where the metric of the stage measures dihedral angles
  kMixed,
};

/// What every pass of a run needs to know, and how long it goes on.
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
  int rounds = 12;           ///< of one operator in one pass, at most
  std::size_t little = 200;  ///< a pass ends with a round that commits less than 1/little of its first one
  /// Factor by which a new vertex or a searched cluster has to raise the worst decision value.
  double least_gain = 1.02;
  int insert_rounds = 200;          ///< of insertion, which takes seeds that lie apart
  std::size_t cells_of_vertex = 4;  ///< that a new one takes, about
  std::size_t search_points = 14;   ///< points of a cavity whose fillings are searched (ClusterSearch)
  std::size_t search_nodes = 300;   ///< of each search: more found little more on the test meshes
  /// Where more cells than this wait for a vertex, only the most promising sites are followed up for each:
  /// `sites_of_many` find the same as all on the test meshes, in half the time; for the last ones each
  /// counts.
  std::size_t few_seeds = 64;
  std::size_t sites_of_many = 3;
  /// Least promise of such a site; see VertexInsertion::least_promise. With a frozen surface nearly half of
  /// the cells have no site of more, and one in twelve of these a plan.
  double promise_of_many = 0;
  /// Where so many vertices of a curved surface are looked at, or one in `many_moves_share` of the mesh, the
  /// worst cell of a star has to rise by `move_gain` for its vertex to move: moves cost far more there than
  /// inside, and each calls for others.
  std::size_t many_moves = 300;
  std::size_t many_moves_share = 8;
  double move_gain = 1.05;
};

/// Mending inverted and flat cells.
struct UntangleEffort {
  /// Layers of cells round the invalid ones whose vertices are moved together, and visits to each vertex.
  struct Width {
    int layers;
    int sweeps;
  };
  std::array<Width, 3> widths = {{{1, 6}, {3, 12}, {7, 24}}};
  int patience = 4;      ///< sweeps without fewer inverted cells
  int newton_steps = 3;  ///< at a vertex
  /// Decision values of volume-length, from what is all but flat to what is merely poor: cells below one are
  /// worked on, below the next only when that has stopped helping.
  std::array<double, 4> focus = {1e-4, 1e-2, 0.1, 0.3};
  int iterations = 40;  ///< at all of them together
  int idle = 2;         ///< iterations without fewer invalid cells or a better worst one
  int restarts = 6;     ///< of reconnection after moving
};

/// All cells in one metric.
struct BulkEffort {
  Metric metric = Metric::kVolumeLength;
  int iterations = 3;
  /// Cells whose decision value is below are worked on. For volume-length 0.45 (q = 0.67): working on all
  /// cells of the 609,574-cell cavity raises the 1st percentile of the smallest dihedrals by 0.1 degrees more
  /// and takes half as long again.
  double focus = std::numeric_limits<double>::infinity();
  bool removes_vertices = false;
};

/// Removal of vertices wherever it helps.
struct CoarsenEffort {
  double below = 50;    ///< degrees; cells that are worked on
  int iterations = 20;  ///< at most
  double still = 0.98;  ///< share of an iteration's cells that may be left for another one
};

/// Work on cells with an angle below a target.
struct PolishEffort {
  int iterations = 60;  ///< at most
  /// An iteration that neither lowers the number of poor cells nor raises the worst decision value by `gain`
  /// is idle; after `idle` of them in a row dearer operators are asked.
  double gain = 1.01;
  int idle = 2;
  /// Where the shape of the surface may change there is always something that gets better by little: with
  /// more than `many` poor cells an iteration is idle unless it mends one in `least_fewer`.
  std::size_t many = kNoLimit;
  std::size_t least_fewer = 10;
  /// Poor cells up to which vertices are inserted for them: `few_to_dig`, or one cell in `dig_share`.
  std::size_t few_to_dig = 50;
  std::size_t dig_share = 48;
  /// Tenths of the poor cells of the last insertion that may be left for the next one, unless the worst has
  /// risen: more vertices would only fill the place with poor cells.
  std::size_t dig_again_tenths = 9;
  /// Poor cells up to which clusters are searched; 0: as many as vertices are inserted for.
  std::size_t few_to_search = 100;
  Selection selection = Selection::kMixedOnAngles;
};

/// The worst angles before the bulk stage, which knows only volume-length and can box them in.
struct FirstPolish {
  PolishEffort polish;
  double target = 15;          ///< degrees
  double largest_share = 0.1;  ///< of cells below it; where there are more, the bulk stage comes first
};

/// An angle that the worst cells are raised to.
struct TargetAngle {
  double degrees;
  /// Where a larger share of the cells lies below a target that nobody asked for, the mesh as a whole is
  /// beyond it, and going on would only remove vertices.
  double largest_share = 1;
  /// Left out where the worst is below this angle: for meshes that end far below, one more in vain.
  double from = 0;
};

/// Raising the worst cells from target to target.
struct TargetEffort {
  std::vector<TargetAngle> targets;  ///< ascending; the last is the goal where one was asked for
  std::vector<TargetAngle> beyond;   ///< all of them: work for more makes room that a goal's last cells lack
  /// Beyond what most meshes come to, a target is tried only when the one before was reached.
  double in_turn_beyond = 25;
};

/// New vertices where the mesh lacks them.
struct RefineEffort {
  double below = 30;         ///< degrees; cells that vertices are put in for
  double least_share = 0;    ///< of cells below that show that vertices are missing
  double largest_share = 1;  ///< beyond which the mesh is poor throughout, and vertices would not mend it
  double gain = 1.6;         ///< factor by which a vertex raises sin² of the worst of its cells
  /// Of 100 cells that the run may make, those there may be afterwards; the rest is for the worst cells.
  std::size_t of_hundred = 100;
  int iterations = 60;  ///< at most
  double fewer = 0.98;  ///< vertices go in when an iteration leaves more than this share of the poor cells
  std::size_t one_in = 50;  ///< and no more once fewer than one in so many of these got one
};

/// Work on the surroundings of a few cells that miss an angle by little, as if the angle were larger: that
/// makes room.
struct NeighbourhoodEffort {
  struct Try {
    int layers;      ///< of cells round them
    double degrees;  ///< that the angle is larger
  };
  std::array<Try, 4> tries = {{{2, 2.5}, {2, 5}, {4, 2.5}, {4, 5}}};
  std::size_t few = 12;  ///< cells at most
  int iterations = 4;    ///< of each try
  double largest = 60;   ///< degrees that are worked for
  /// Poor cells up to which vertices are inserted: where the surface may change its shape and there are more,
  /// those that are put in for the sake of room go to the wrong places, at most of the cost.
  std::size_t few_to_dig = kNoLimit;
};

/// Ways there are to put an apex over each needle of a patch at once.
inline constexpr std::size_t kNeedleRows = 2;

/// Tries on copies of the surroundings of the worst cells: "insertion followed by smoothing and topological
/// improvement", kept or rolled back as one step (Klingner & Shewchuk 2007).
struct PatchEffort {
  std::size_t few = 64;            ///< cells below the next angle; where there are more, nothing is tried
  int layers = 3;                  ///< of cells round the worst one
  std::size_t patches = 4;         ///< at a time
  int turns = 12;                  ///< at most
  std::size_t rows = kNeedleRows;  ///< of apexes over needles that are tried
  std::size_t vertices = 8;        ///< new ones for one patch, each in a try of its own
  std::size_t removals = 12;       ///< vertices next to the worst cell that are taken out instead
  double degrees = 0.6;            ///< beyond the worst angle, that are worked for in a turn
};
/// Where the surface is frozen, and nobody asked for more.
inline constexpr PatchEffort kLittleEffort = {};
/// Where the surface may change, which has cheaper ways to mend needles, but for the very last cells.
inline constexpr PatchEffort kSurfaceEffort = {.turns = 4, .rows = 0};
/// For the very last cells, one after the other.
inline constexpr std::array<PatchEffort, 2> kLastEfforts = {
    {{.few = 6, .layers = 2, .turns = 2, .vertices = 20, .removals = 30},
     {.few = 6, .layers = 4, .turns = 2, .vertices = 12, .removals = 30}}};
/// One after the other, where the worst angle is to be raised at any cost: what one cannot mend, another may.
inline constexpr std::array<PatchEffort, 3> kAllEfforts = {
    {{.patches = 8, .turns = 40, .vertices = 20, .removals = 20, .degrees = 2},
     {.layers = 4, .patches = 8, .turns = 40, .vertices = 20, .removals = 20, .degrees = 0.5},
     {.layers = 2, .patches = 8, .turns = 40, .vertices = 20, .removals = 20, .degrees = 3}}};

/// What holds for each try on a patch.
struct PatchTrial {
  bool enabled = true;     ///< not without insertion, nor where iterations are limited
  double loss = 0.02;      ///< of sin² of the worst cell, that a new vertex may leave at first
  double any_loss = 1e-4;  ///< the same for vertices that count together only
  double flat = 1e-5;      ///< sin² of a cell that is all but flat, which removal may leave at first
  double rise = 1.002;     ///< times sin² of the worst cell of a patch: less is not worth its cells
  double ahead = 1.05;     ///< times the target, which is worked for
  double largest = 60;     ///< degrees that are worked for
  int iterations = 8;      ///< of the polish of one try: more found no more
  bool has_surface =
      false;  ///< whether the patch's part of the surface may change, too: flat ones may, while
              ///< a curved one is held to the shape of the input, which a patch does not know
};

/// The last few cells below a target.
struct LastCellsEffort {
  double up_to = 30;     ///< degrees; targets beyond are left unless a goal was asked for
  double again = 1.002;  ///< factor by which the worst angle has to rise for neighbourhoods to be tried again
  double rise = 1.002;   ///< and for the stage to say that it has
  /// Patches that are searched before the neighbourhoods: the surroundings of a flat surface take vertices
  /// wherever they may; towards a goal patches need fewer.
  std::vector<PatchEffort> patches_first;
  std::vector<PatchEffort> patches;  ///< that are searched after them
  /// Degrees up to which they are: where the surface may change its shape, which patches do not know, there
  /// are cheaper ways beyond.
  double patches_up_to = std::numeric_limits<double>::infinity();
};

/// An angle that was asked for.
struct GoalEffort {
  double degrees = 0;
  /// Where a larger share of the cells misses it, all cells are worked on before it is worked for: most would
  /// be touched anyway, and polished by themselves they would lose too many vertices.
  double many_miss = 0.2;
  /// Where no larger share is left in the end, a frozen surface holds them, whatever is done to others.
  double few_miss = 0.01;
  bool goes_on = true;  ///< with all cells where the goal was missed; not where iterations are limited
};

/// The worst angle as far as it goes, whatever it costs in time: after a default run.
struct AnyCostEffort {
  CellBounds bounds;
  /// Of 100 cells that the default run leaves, those that there may be; 0: as bounds say. With a surface
  /// whose facets stay planar it needs no more than otherwise; with one that may change its shape, a single
  /// cell that nothing mends would draw vertices without end: 20 cells came to 14,842 in 12 s.
  std::size_t most_of_hundred = 150;
  PolishEffort polish;
  std::vector<TargetAngle> targets;
  int missed = 4;               ///< targets in a row that may be missed
  double gain = 1.002;          ///< factor of the worst angle that makes a target no miss
  double fewer = 0.8;           ///< share of the cells below it that may be left, for the same
  double again = 1.02;          ///< factor by which a search of the worst cells starts the climb anew
  bool neighbourhoods = false;  ///< improved at each target, and not only at the last
  std::vector<PatchEffort> patches;
  std::optional<RefineEffort> refine, refine_again;
};

/// The enclosed volume, given back at the end.
struct VolumeEffort {
  bool keeps_angles_only =
      false;  ///< judges by dihedral angles, so that a goal is not lost for an obtuse one
  int passes = 8;
  double enough = 5e-5;  ///< of the volume
};

/// The paper's pipeline.
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
  TargetEffort targets;
  std::optional<RefineEffort> refine, refine_again;
  std::optional<NeighbourhoodEffort> neighbourhoods;
  PatchTrial patch;
  LastCellsEffort last_cells;
  std::optional<GoalEffort> goal;
  std::optional<AnyCostEffort> any_cost;
  std::optional<VolumeEffort> volume;
  CompatEffort compat;

  /// For cells that have fallen below the input's worst angle.
  const PolishEffort& mending() const { return any_cost ? any_cost->polish : polish; }
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
