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

namespace hfr {

/// Operators that a run may use; a set of bits.
enum class Ops : unsigned {
  kNone = 0,
  kEdge = 1,     ///< edge removal
  kFace = 2,     ///< 2-3 face swap; towards an angle, also removal of several faces
  kNode = 4,     ///< vertex removal by collapse onto a neighbour
  kSmooth = 8,   ///< vertex smoothing
  kInsert = 16,  ///< a new vertex in a dug cavity, for the few cells that nothing else mends
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
  /// Instead of a goal: raise the smallest dihedral as far as it goes, whatever it costs in time and cells.
  bool raise_min_dihedral = false;
  int iterations = 0;  ///< limit of bulk iterations, or of all with a goal; 0 = until little is gained
  double time_limit = std::numeric_limits<double>::infinity();  ///< seconds, for improve() alone
  Ops ops = Ops::kDefault;
  Metric metric = Metric::kVolumeLength;  ///< of the bulk passes
  Smoother smoother = Smoother::kNewton;
  Compat compat = Compat::kNone;
  std::uint64_t seed = 1;  ///< of the priorities among candidates of equal worth
  par::Policy policy = par::Policy::all();
  /// Where the large passes run; the results are the same bits everywhere. Where an OpenCL device is named
  /// and missing, too small, or broken, improve() throws DeviceError; kAuto goes on without it.
  DeviceChoice device;
  /// On a device, smooth only, and reconnect on the processor: the division of work of D'Amato & Venere
  /// (2013).
  bool hybrid = false;
  DeviceTuning device_tuning;
  bool statistics = true;  ///< fill Result::before and after
  /// Called between passes, from the calling thread.
  std::function<void(const Progress&)> progress;
  /// Asked between passes; true stops the run with the mesh as it is then: valid, no worse than before.
  std::function<bool()> cancel;
};

/// kDeviceLost: the device that was asked for failed in the middle; the mesh is that of the last finished
/// round.
enum class Stop { kGoal, kNoProgress, kIterations, kTimeLimit, kCancelled, kDeviceLost };

/// One operator over the mesh once.
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

struct Result {
  bool changed = false;
  bool goal_reached = false;  ///< nothing inverted or flat, and min_dihedral met where given
  Stop stop = Stop::kNoProgress;
  std::vector<PassReport> passes;
  Statistics before, after;               ///< when options.statistics
  std::vector<CellHandle> invalid_cells;  ///< inverted or flat cells that remain
  double seconds = 0;                     ///< of the work itself, statistics apart
  double seconds_device = 0;              ///< to open the device and get its kernels, part of `seconds`
  std::string device;                     ///< name of the device that was opened; empty: none
  std::string device_note;                ///< why a device that was wanted was not used, or not to the end
  std::vector<KernelTime> kernel_times;   ///< when device_tuning.profile
};

/// Improves `mesh` in place. The worst cell of every changed cluster gets better; boundary, region
/// interfaces, labelled faces and edges and fixed vertices keep every bit. Deleted cells and vertices are
/// collected before it returns. Throws InvalidInput for options out of range.
Result improve(TetMesh& mesh, const ImproveOptions& options = {});

}  // namespace hfr

#endif
