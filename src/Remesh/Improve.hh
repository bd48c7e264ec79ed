// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_IMPROVE_HH
#define HFR_REMESH_IMPROVE_HH

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "Device/DeviceMesh.hh"
#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"
#include "Quality/Metrics.hh"
#include "Quality/Statistics.hh"
#include "Remesh/Limits.hh"
#include "Remesh/MeshMaps.hh"
#include "Surface/SurfaceOptions.hh"

namespace hfr {

/// Operators that a run may use; a set of bits.
enum class Ops : unsigned {
  kNone = 0,
  kEdge = 1,      ///< edge removal
  kFace = 2,      ///< 2-3 face swap; towards an angle, also removal of several faces
  kNode = 4,      ///< vertex removal by collapse onto a neighbour
  kSmooth = 8,    ///< vertex smoothing
  kInsert = 16,   ///< a new vertex in a dug cavity, for the few cells that nothing else mends
  kCluster = 32,  ///< branch and bound over all ways to connect the points round such a cell; not by default
  kDefault = kEdge | kFace | kNode | kSmooth | kInsert,
};
constexpr Ops operator|(Ops a, Ops b) {
  return static_cast<Ops>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
constexpr Ops without(Ops set, Ops op) {
  return static_cast<Ops>(static_cast<unsigned>(set) & ~static_cast<unsigned>(op));
}
constexpr bool has(Ops set, Ops op) { return (static_cast<unsigned>(set) & static_cast<unsigned>(op)) != 0; }
/// From a comma-separated list such as "edge,face,node,smooth"; throws InvalidInput that lists the names.
Ops ops_from_list(const std::string& list);
std::string ops_to_list(Ops ops);

/// Which smoothing a run uses.
enum class Smoother { kNewton, kCandidates, kLaplacian, kTaubin };
Smoother smoother_from_name(const std::string& name);

/// Whether edge removal, face swap and vertex removal run one kind after the other, or compete in one
/// selection where the largest gain wins. kAuto: competing while the worst cells are raised as far as they
/// go; in turn otherwise (measured in docs/scheduler.md).
enum class Rounds { kAuto, kByKind, kMixed };
Rounds rounds_from_name(const std::string& name);

/// A pipeline to reproduce exactly.
enum class Compat { kNone, kJpdc2013 };

struct Progress {
  std::string stage;    ///< "untangle", "bulk", "polish", …
  int iteration = 0;    ///< from 1, within the stage
  double fraction = 0;  ///< 0 … 1 of the whole run, an estimate
  std::size_t n_inverted = 0;
  double min_dihedral = 0;  ///< degrees
};

struct ImproveOptions {
  /// Goal for the smallest dihedral angle, degrees, in (0, 70.5). With a goal, only cells that miss it are
  /// worked on. Without one, the whole mesh is improved and its worst cells are raised as far as they go.
  std::optional<double> min_dihedral;
  /// Instead of a goal: raise the smallest dihedral as far as it goes, whatever it costs in time.
  bool raise_min_dihedral = false;
  int iterations = 0;  ///< limit of bulk iterations, or of all with a goal; 0 = until little is gained
  double time_limit = std::numeric_limits<double>::infinity();  ///< seconds, for improve() alone
  Ops ops = Ops::kDefault;
  Metric metric = Metric::kVolumeLength;  ///< of the bulk passes
  /// Vertex removal in the bulk stage as well, on the surface, too, where that may change: fewer cells,
  /// better percentiles on some meshes, and a lower worst angle on most (measured in docs/worst-angles.md).
  bool bulk_nodes = false;
  /// No vertex is removed where cells would come to be fewer than min_cells, none inserted where more than
  /// max_cells; swaps may add or take a few. 0: the run chooses, of 100 cells of the input
  ///   - with a frozen surface 81 and 119;
  ///   - in flat mode with raise_min_dihedral 81 and 119, with min_dihedral no lower bound and 119, else
  ///   none;
  ///   - in free mode, and with compat, none.
  /// With coarsen there is no lower bound but one that is given. Towards min_dihedral the bounds that the run
  /// has chosen are dropped once they were in the way and nothing else helps. With raise_min_dihedral,
  /// frozen or free, max_cells is in the end 150 of 100 cells of what the default run leaves.
  std::size_t min_cells = 0;
  std::size_t max_cells = 0;
  /// Vertices are removed wherever that makes the worst angle of their cells better: without a goal a stage
  /// of its own looks for them. Of bounds on fewer cells only a min_cells that is given holds; max_cells is
  /// the number of cells of the input unless given.
  bool coarsen = false;
  Smoother smoother = Smoother::kNewton;
  Rounds rounds = Rounds::kAuto;
  Compat compat = Compat::kNone;
  SurfaceOptions surface;  ///< frozen by default; other modes need a build with OpenMesh
  std::uint64_t seed = 1;  ///< of the priorities among candidates of equal worth
  par::Policy policy = par::Policy::all();
  /// Where the large passes run; the results are the same bits everywhere. Where an OpenCL device is named
  /// and missing, too small, or broken, improve() throws DeviceError; kAuto goes on without it.
  DeviceChoice device;
  /// On a device, smooth only, and reconnect on the processor: the division of work of D'Amato & Venere
  /// (2013).
  bool hybrid = false;
  DeviceTuning device_tuning;
  bool statistics = true;  ///< fill Result::before and after, and what is said of stuck cells
  bool maps = false;       ///< fill Result::maps: 28 bytes a cell, and 12 a vertex
  /// Called between passes, from the calling thread. What it throws, improve() throws, with the mesh as after
  /// a cancel.
  std::function<void(const Progress&)> progress;
  /// Asked between passes; true stops the run with the mesh as it is then, or, where that is worse than the
  /// input in what improve() promises, as it was at a stage before.
  std::function<bool()> cancel;
};

/// kDeviceLost: the device that was asked for failed in the middle; the mesh is that of the last finished
/// round, as after a cancel.
enum class Stop { kGoal, kNoProgress, kIterations, kTimeLimit, kCancelled, kDeviceLost };

/// One operator over the mesh once. With the stage and op "undo": the passes before, some or all, were taken
/// back, and n_inverted and worst (of the smallest dihedral) are those of the mesh that was put back.
struct PassReport {
  std::string stage;
  std::string op;
  int iteration = 0;
  std::size_t rounds = 0;
  std::size_t seeds = 0;       ///< looked at
  std::size_t candidates = 0;  ///< that would improve their cluster
  std::size_t winners = 0;     ///< committed
  std::size_t sub_rounds = 0;  ///< of the selections; as many as rounds where one thread marks
  bool on_device = false;
  std::size_t n_inverted = 0;  ///< after the pass
  double worst = 0;            ///< smallest decision value of the pass's metric after it
  double seconds = 0;
  double seconds_evaluate = 0;
  double seconds_select = 0;
  double seconds_commit = 0;
};

/// The volume of a region before and after, summed up from its cells.
struct RegionChange {
  int region = 0;
  double before = 0, after = 0;
};

/// What became of the surface, measured by itself; all 0 while it is frozen, and but for the first two where
/// no statistics are asked for. Lengths are in the mesh's units.
struct SurfaceReport {
  SurfaceMode mode = SurfaceMode::kFrozen;
  double bound = 0;      ///< largest distance that was allowed
  double hausdorff = 0;  ///< largest distance of the result from the input or of the input from the result
  double diagonal = 0;   ///< of the input's bounding box
  /// Distance to allow (SurfaceOptions::hausdorff) for folds of the surface to be unfolded, where what was
  /// allowed does not do; 0 otherwise.
  double unfold_needs = 0;
  double volume_change = 0;  ///< of the enclosed volume, as a share of it
  std::size_t feature_edges = 0;
  std::size_t triangles_before = 0, triangles_after = 0;
  std::vector<RegionChange> regions;  ///< ascending; empty where there is but one
};

/// Cells below Result::stuck_below that a frozen surface is proven to keep there, or for which nothing was
/// found and none of whose vertices may move; and which mode would let their surface change.
struct HeldCells {
  std::size_t cells = 0;
  bool known = false;  ///< whether the rest is; not without OpenMesh
  std::size_t by_flat = 0;
  std::size_t by_free = 0;   ///< that flat would not free
  std::size_t by_shape = 0;  ///< that neither would: corners, and features narrower than the angle
};

struct Result {
  bool changed = false;       ///< by what was not taken back
  bool goal_reached = false;  ///< nothing inverted or flat, and min_dihedral met where given
  Stop stop = Stop::kNoProgress;
  std::vector<PassReport> passes;
  Statistics before, after;  ///< when options.statistics
  SurfaceReport surface;
  std::vector<CellHandle> invalid_cells;  ///< inverted or flat cells that remain
  /// Boundary faces that lie on one another, when invalid cells remain; see folded_faces().
  std::vector<HalfFaceHandle> folded_faces;
  /// Of these, and of the boundary faces of invalid cells, those at which every mesh with this boundary has
  /// an invalid cell; see unfillable_faces().
  std::vector<HalfFaceHandle> unfillable_faces;
  /// With options.statistics: the cells below `stuck_below` degrees, which is the goal or, where the worst
  /// angle was raised as far as it goes, the first angle that was tried for and missed; and what keeps each.
  std::vector<StuckCell> stuck;
  double stuck_below = 0;
  HeldCells held;  ///< with a frozen surface and options.statistics
  /// With options.statistics: vertices of more than Star::kCapacity cells, which are moved but not removed.
  std::size_t n_large_stars = 0;
  double seconds = 0;                    ///< of the work itself, statistics apart
  double seconds_device = 0;             ///< to open the device and get its kernels, part of `seconds`
  std::string device;                    ///< name of the device that was opened; empty: none
  std::string device_note;               ///< why a device that was wanted was not used, or not to the end
  std::vector<KernelTime> kernel_times;  ///< when device_tuning.profile
  MeshMaps maps;                         ///< when options.maps
};

/// Improves `mesh` in place. Boundary, region interfaces, labelled faces and edges and fixed vertices keep
/// every bit, unless options.surface lets the surface change. Deleted cells and vertices are collected before
/// it returns.
///
/// However the run ends, with its goal, without, by time, by cancel, by a device that is lost or by an
/// exception of a callback, the mesh is no worse than it was: it has no more inverted cells, no more inverted
/// and flat cells together, no more overlap (the sum of |volume| of the inverted cells) and no smaller worst
/// dihedral angle. Stages that may lower these are begun with a copy of the mesh; what is worse in the end
/// becomes the best that was kept. Handles of properties stay valid.
///
/// Throws InvalidInput for options out of range, and InternalError, with the mesh as it was kept, where
/// operators have broken a rule of check(): see Checkpoint.hh.
Result improve(TetMesh& mesh, const ImproveOptions& options = {});

}  // namespace hfr

#endif
