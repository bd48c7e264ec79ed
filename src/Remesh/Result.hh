// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RESULT_HH
#define HFR_REMESH_RESULT_HH

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "hfremesh/Device/Device.hh"
#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/Quality/Statistics.hh"
#include "hfremesh/Surface/SurfaceOptions.hh"
#include "hfremesh/Transfer/MeshMaps.hh"

namespace hfr {

/// kDeviceLost: the device that was asked for failed in the middle; the mesh is that of the last finished
/// round, as after a cancel.
enum class Stop { kGoal, kNoProgress, kIterations, kTimeLimit, kCancelled, kDeviceLost };

/// "goal", "no progress", "iterations", "time limit", "cancelled", "device lost".
const char* stop_name(Stop stop);

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
  double bound = 0;  ///< largest distance that was allowed
  /// Largest distance of the result from the input or of the input from the result. The input has its plane
  /// walls opened here, where they were folded over and that has not been taken back.
  double hausdorff = 0;
  double diagonal = 0;  ///< of the bounding box of that input
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

/// Why a cell is below an angle, the strongest reason first. The first four are proofs, for meshes whose
/// cells go round each edge no more than once; then come bounds that the run met; the last claims nothing.
enum class StuckReason {
  kFoldedSurface,   ///< an inverted or flat cell that touches a boundary face of unfillable_faces()
  kSurfaceCeiling,  ///< two boundary faces leave too narrow a wedge, or one that a single poor cell has to
                    ///< fill
  kInputFeature,    ///< the same where an interface between regions or a labelled face inside takes part
  kSurfaceFeature,  ///< with a surface that may change: see feature_ceilings()
  kMaxCells,        ///< a new vertex would raise the worst of its surroundings, and the bound on cells is met
  kTimeLimit,       ///< the run was ended before it was done: by the time,
  kCancelled,       ///< by the caller,
  kIterations,      ///< by the number of iterations,
  kDeviceLost,      ///< by a device that failed
  kNotFound,        ///< nothing better was found, which proves nothing
};
inline constexpr std::array<const char*, 10> kStuckReasonNames = {
    "folded surface", "surface ceiling", "input feature", "surface feature", "max cells",
    "time limit",     "cancelled",       "iterations",    "device lost",     "not found"};

/// Whether the reason is that no mesh which keeps the faces has a larger angle there.
constexpr bool is_proof(StuckReason limit) { return limit <= StuckReason::kSurfaceFeature; }

struct StuckCell {
  CellHandle cell;
  double degrees = 0;  ///< its smallest dihedral; not positive for an inverted or flat cell
  StuckReason reason = StuckReason::kNotFound;
  int n_frozen_vertices = 0;  ///< of its four
  /// Where the limit is a surface ceiling or a feature, the proof: while the faces at the edge (a, b) that
  /// may not change stay as they are, or in the planes where they are, some cell at this edge has a dihedral
  /// of at most `ceiling` degrees in every mesh; not positive where one is inverted or flat in every mesh.
  double ceiling = 180;
  VertexHandle a, b;
};

/// How many cells each reason keeps, in the order of StuckReason.
std::array<std::size_t, kStuckReasonNames.size()> count_reasons(const std::vector<StuckCell>& cells);

/// The bound on the number of cells, where it was met: of the cells below Result::stuck_below, a new vertex
/// would raise some, or there is no room for one. Empty where it was not.
struct CellBoundMet {
  std::size_t bound = 0;  ///< cells that there might be; 0: no bound was met
  std::size_t cells = 0;  ///< of those below, with StuckReason::kMaxCells
  /// ImproveOptions::max_cells that has room for a vertex at each of them; 0 where there are none, and no one
  /// vertex raises the worst cells: what more of them do is not known.
  std::size_t wanted = 0;
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
  CellBoundMet cell_bound;  ///< with options.statistics
  HeldCells held;           ///< with a frozen surface and options.statistics
  /// With options.statistics: vertices of more than Star::kCapacity cells, which are moved but not removed.
  std::size_t n_large_stars = 0;
  double seconds = 0;                    ///< of the work itself, statistics apart
  double seconds_device = 0;             ///< to open the device and get its kernels, part of `seconds`
  std::string device;                    ///< name of the device that was opened; empty: none
  std::string device_note;               ///< why a device that was wanted was not used, or not to the end
  std::vector<KernelTime> kernel_times;  ///< when device_tuning.profile
  MeshMaps maps;                         ///< when options.maps
};

}  // namespace hfr

#endif
