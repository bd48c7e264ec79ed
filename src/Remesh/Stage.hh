// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_STAGE_HH
#define HFR_REMESH_STAGE_HH

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "Device/DeviceMesh.hh"
#include "HalfFace/TetMesh.hh"
#include "Operators/AnyOf.hh"
#include "Operators/ClusterSearch.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/FanMerge.hh"
#include "Operators/Metrics.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/SmoothLaplacian.hh"
#include "Operators/SmoothMaxMin.hh"
#include "Operators/SmoothNewton.hh"
#include "Operators/StarFromVertex.hh"
#include "Operators/VertexInsertion.hh"
#include "Operators/VertexRemoval.hh"
#include "Remesh/Improve.hh"
#include "Remesh/RunControl.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/Seeds.hh"
#include "Scheduler/SmoothPass.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

/// Which cells a pass works on.
struct Focus {
  /// Cells whose decision value is below this; infinity: all.
  double below = std::numeric_limits<double>::infinity();
  /// Unless empty, only cells with a vertex that is marked here, or that is newer.
  std::span<const std::uint8_t> around = {};
  bool everything() const { return below == std::numeric_limits<double>::infinity(); }
};

/// The passes of a run in one metric. Work follows damage: a pass looks at cells that are in focus and that,
/// or whose surroundings, have changed since the same operator last looked at them in this stage.
template <class Metric>
class Stage {
 public:
  Stage(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control, Metric metric,
        std::string name)
      : mesh_(mesh),
        work_(work),
        options_(options),
        control_(control),
        metric_(metric),
        name_(std::move(name)) {
    work_.set_qualities(mesh_, metric_, options_.policy);
    std::fill(work_.pending.begin(), work_.pending.end(), 0xff);
    work_.all_touched = true;
    count(Focus{});
    if (control_.checkpoint() && may_lower_angles()) control_.keep(mesh_, n_invalid_ == 0);
  }

  std::size_t n_invalid() const { return n_invalid_; }
  /// Smallest decision value of the mesh.
  double worst() const { return worst_; }
  std::size_t n_below(double value) { return poor(value).size(); }

  /// Forgets what was looked at, so that a pass with a wider focus or other operators sees every cell again.
  void look_again() {
    to_host();
    looked_.fill(0);
    waiting_.clear();
    looked_at_surface_.fill(0);
    std::fill(work_.pending.begin(), work_.pending.end(), 0xff);
  }

  /// One iteration of the operators that options allow, in the paper's order: edge, face, node, smooth.
  /// Returns the number of committed changes.
  std::size_t iterate(int iteration, Focus focus, bool with_node);

  std::size_t edge_pass(int iteration, Focus focus);
  std::size_t face_pass(int iteration, Focus focus);
  std::size_t node_pass(int iteration, Focus focus);
  /// Face swap and its extension to several faces; more than face_pass finds, at three times its cost.
  std::size_t multi_face_pass(int iteration, Focus focus);
  /// Cells in a row round an edge that stays, such as one of the surface, into one there.
  std::size_t fan_pass(int iteration, Focus focus);
  /// A new vertex in a cavity that is dug round a poor cell: the most expensive pass. It must raise sin² (or
  /// what else the metric decides by) of the worst cell of the cavity by the factor `gain`.
  std::size_t insert_pass(int iteration, Focus focus, double gain = kLeastGain);
  /// All ways to connect the points round a poor cell: milliseconds a cell.
  std::size_t cluster_pass(int iteration, Focus focus);
  std::size_t smooth_pass(int iteration, Focus focus);
  /// Edge removal, face swap and, with_node, vertex removal in one selection: a cluster goes to the kind that
  /// gains most.
  std::size_t mixed_pass(int iteration, Focus focus, bool with_node);
  /// The paper's star form of an operator over all cells that are pending.
  template <Cluster kStar>
  std::size_t star_pass(int iteration);
  /// The operators on the surface that options allow: swap, collapse, smooth; nothing while it is frozen.
  std::size_t surface_pass(int iteration, Focus focus, bool with_node);
  /// Moves the surface as a whole until the volume is what it was, where no cell suffers.
  void restore_volume();

  /// Brings the mesh back from the device, where passes may have left it; at the end of a stage, at the
  /// latest.
  void to_host();

 private:
  /// Of a vertex that is inserted, or a cluster that is searched, at least.
  static constexpr double kLeastGain = 1.02;
  enum Kind : std::uint8_t {
    kEdge,
    kFace,
    kNode,
    kInsert,
    kSmooth,
    kMultiFace,
    kMixed,
    kCluster,
    kFan,
    kKinds
  };
  /// As in a list of operators: variants of one are reported as one.
  static constexpr std::array<const char*, kKinds> kNames = {"edge", "face",  "node",    "insert", "smooth",
                                                             "face", "mixed", "cluster", "edge"};

  /// Cells that operator `kind` has to look at; they count as looked at from now on.
  Worklist worklist(Kind kind, Focus focus) {
    to_host();
    if (focus.everything()) {
      HFR_ASSERT(kind < 8);  // a bit each in a byte; the later ones always have a focus
      const auto bit = static_cast<std::uint8_t>(1U << kind);
      return Worklist(mesh_, options_.policy, [&](CellHandle c) {
        if (!(work_.pending[c.idx()] & bit)) return false;
        work_.pending[c.idx()] = static_cast<std::uint8_t>(work_.pending[c.idx()] & ~bit);
        return true;
      });
    }
    const std::uint32_t since = looked_[kind];
    looked_[kind] = work_.clock;
    return Worklist(mesh_, options_.policy, poor(focus.below), [&](CellHandle c) {
      const auto& v = mesh_.cell(c).v;
      return std::any_of(v.begin(), v.end(),
                         [&](VertexHandle u) { return work_.changed[u.idx()] > since; }) &&
             (focus.around.empty() || std::any_of(v.begin(), v.end(), [&](VertexHandle u) {
                return u.idx() >= focus.around.size() || focus.around[u.idx()];
              }));
    });
  }

  /// Whether the smallest dihedral of the mesh may come to be below that of the run's input: operators raise
  /// the worst cell of a cluster in the metric, and only in this.
  bool may_lower_angles() const {
    if (n_invalid_ > 0) return true;
    if constexpr (std::is_same_v<Metric, MinDihedral>) return false;
    // The smallest sine, which may be that of an obtuse angle, is never above the smallest dihedral's.
    if constexpr (std::is_same_v<Metric, MinSine2>) return worst_ < control_.checkpoint()->input().worst;
    return true;
  }

  /// Whether iterations put several kinds into one selection.
  bool is_mixed() const;

  /// Cells that a round may take away from a mesh of n_cells; see RoundOptions::may_lose.
  std::size_t may_lose(std::size_t n_cells) const {
    return options_.min_cells > 0 ? n_cells - std::min(n_cells, options_.min_cells) : RoundOptions{}.may_lose;
  }

  /// And add to one; see RoundOptions::may_gain.
  std::size_t may_gain(std::size_t n_cells) const {
    return options_.max_cells > 0 ? options_.max_cells - std::min(n_cells, options_.max_cells)
                                  : RoundOptions{}.may_gain;
  }

  /// Whether the bound on cells leaves room for a new vertex.
  bool has_room() const;

  /// Vertices of the listed cells that an operator may take out.
  std::vector<VertexHandle> removable(const Worklist& list) const;

  /// Of the listed cells and those that wait, the worst first, those that share no vertex with one before;
  /// the others wait for the next round. Neighbours would dig the same cavity, and most of them lose.
  std::vector<CellHandle> worst_apart(const Worklist& list, Focus focus);

  /// Rounds of one operator until they bring little, then a line in the report.
  template <class MakeOp, class RunRound>
  std::size_t rounds(Kind kind, int iteration, Focus focus, MakeOp&& make_op, RunRound&& run_round);

  /// Cells whose decision value is below `value`, ascending. Asked again with the same value, it looks only
  /// at what has been written since.
  std::span<const Index> poor(double value);

  /// Brings n_invalid_ and worst_ up to date. With a focus that holds a cell, both are found inside it.
  void count(Focus focus);

  void report(const char* op, int iteration, const RoundCounts& counts, double seconds);

  // --- SurfaceStage.cc ---
  /// Cells in focus that, or whose surroundings, have changed since the clock stood at `since`.
  Worklist changed_since(std::uint32_t since, Focus focus);
  std::size_t surface_swaps(int iteration, const Worklist& list);
  template <class Op>
  std::size_t surface_swaps(const char* name, bool inside, int iteration, const Worklist& list);
  std::size_t surface_collapses(int iteration, const Worklist& list);
  std::size_t surface_moves(int iteration, const Worklist& list);
  /// Moves the vertices of periodic patches, orbit by orbit: few, so one after the other.
  RoundCounts periodic_moves(std::span<const VertexHandle> first_of_orbits);
  std::size_t surface_splits(int iteration, Focus focus);
  /// Edges of the boundary in the listed cells, each from its smallest listed cell, that allow(a, b) lets by;
  /// with `inside` those between vertices of the surface that the boundary does not have.
  template <class Allow>
  std::vector<EdgeHandle> surface_edges(const Worklist& list, bool inside, Allow&& allow) const;

  // Passes on the device: StageOnDevice.hh.
  /// True, with the mesh on the device, when passes of this kind run there.
  bool on_device(Kind kind);
  DeviceLook device_look(Kind kind, Focus focus);
  /// rounds() and smooth_pass() on the device; nothing when it failed and the processor has to go on.
  std::optional<std::size_t> device_rounds(Kind kind, int iteration, Focus focus);
  std::optional<std::size_t> device_smooth(int iteration, Focus focus);
  void device_count();
  /// Does on the processor what was done on the device since the mesh was uploaded.
  void lose_device(const std::string& why);

  TetMesh& mesh_;
  Workspace& work_;
  const ImproveOptions& options_;
  RunControl& control_;
  Metric metric_;
  std::string name_;
  std::size_t n_invalid_ = 0;
  double worst_ = 0;
  std::vector<Index> poor_;  // below poor_below_, but for what work_ has as touched
  double poor_below_ = -std::numeric_limits<double>::infinity();
  std::array<std::uint32_t, kKinds> looked_{};
  std::array<std::uint32_t, 4> looked_at_surface_{};  // swap, collapse, smooth, split

  std::vector<Index> waiting_;  // for their turn in insert_pass(), ascending
  double insert_gain_ = 0;      // of the last insert_pass()

  struct DonePass {
    Kind kind;
    Focus focus;
    std::size_t rounds;
  };
  bool resident_ = false;                             // the device has the mesh, the host an older one
  std::vector<DonePass> done_there_;                  // since it was uploaded
  std::array<std::uint32_t, kKinds> looked_there_{};  // looked_ and the clock at that time
  std::uint32_t clock_there_ = 0;
  std::optional<std::size_t> replay_;  // rounds of a pass that is being done again
};

}  // namespace hfr

#endif
