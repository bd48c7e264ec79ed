// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_OPTIONS_HH
#define HFR_REMESH_OPTIONS_HH

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "hfremesh/Device/Device.hh"
#include "hfremesh/Parallel/Policy.hh"
#include "hfremesh/Quality/Metric.hh"
#include "hfremesh/Surface/SurfaceOptions.hh"

namespace hfr {

/// Operators that a run may use; a set of bits.
enum class Ops : unsigned {
  kNone = 0,
  kEdge = 1,      ///< edge removal
  kFace = 2,      ///< 2-3 face swap; towards an angle, also removal of several faces
  kNode = 4,      ///< vertex collapse by collapse onto a neighbour
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

/// Whether edge removal, face swap and vertex collapse run one kind after the other, or compete in one
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
  /// With min_dihedral: the polish alone, after untangling where that is needed. Edges, faces and vertices of
  /// the cells that miss the goal are worked on until nothing helps any more, and new vertices put in where
  /// `ops` has them; no other targets, patches or neighbourhoods, and not all cells. hfr::mpi::improve() of a
  /// mesh in parts does the same with the same bits.
  bool polish_only = false;
  /// Passes over the mesh alone: every stage but the searches for the last few cells, which are patches and
  /// work on the neighbourhoods of single cells. Less time, and a lower worst angle on hard meshes; not with
  /// raise_min_dihedral.
  bool passes_only = false;
  double time_limit = std::numeric_limits<double>::infinity();  ///< seconds, for improve() alone
  Ops ops = Ops::kDefault;
  Metric metric = Metric::kVolumeLength;  ///< of the bulk passes
  /// Vertex collapse in the bulk stage as well, on the surface, too, where that may change: fewer cells,
  /// better percentiles on some meshes, and a lower worst angle on most (measured in docs/worst-angles.md).
  bool bulk_nodes = false;
  /// No vertex is removed where cells would come to be fewer than min_cells, none inserted where more than
  /// max_cells; swaps may add or take a few. 0: the run chooses, of 100 cells of the input
  ///   - with a frozen surface 81 and 119;
  ///   - in flat mode with raise_min_dihedral 81 and 119, with min_dihedral no lower bound and 119, else as
  ///   in free mode no lower bound and 150; with compat none. A run without a goal that ends below 15
  ///   degrees may make 150, then 225 and 338, while that raises the worst angle or, where many cells are
  ///   below, mends some of them; with a frozen surface, where the mesh is poor throughout, as many as
  ///   min_dihedral = 15 would: docs/pipeline.md.
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

}  // namespace hfr

#endif
