// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_PASS_STATE_HH
#define HFR_REMESH_PASS_STATE_HH

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "Remesh/Run.hh"
#include "Scheduler/PoorCells.hh"
#include "Scheduler/Seeds.hh"
#include "Scheduler/Workspace.hh"

namespace hfr {

class DevicePasses;
class RankPasses;

/// Which cells a pass works on.
struct Focus {
  /// Cells whose decision value is below this; infinity: all.
  double below = std::numeric_limits<double>::infinity();
  /// Unless empty, only cells with a vertex that is marked here, or that is newer.
  std::span<const std::uint8_t> around = {};
  /// In a mesh in parts the same, by what MeshInParts::mark_round() has marked last.
  bool is_marked = false;
  bool everything() const { return below == std::numeric_limits<double>::infinity(); }
};

/// Kinds of passes over the cells; what each is called and needs is in PassRunner's table.
enum class PassKind : std::uint8_t {
  kEdge,
  kFace,
  kNode,
  kInsert,
  kSmooth,
  kMultiFace,
  kMixed,
  kCluster,
  kFan,
  kCount
};

/// One call of a pass.
struct Turn {
  int iteration = 0;  ///< from 1, within the stage
  Focus focus = {};
  bool removes_vertices = true;  ///< whether an iteration and a mixed pass may
  /// With more than PassEffort::few_seeds, insertion ends after a round in which fewer than one in so many
  /// got a vertex.
  std::size_t seeds_of_vertex = kNoLimit;
  std::size_t n_held = 0;  ///< seeds of the first round of insertion that do not count among them
  /// Set where a pass is done again that was done on a device which has failed since: so many rounds,
  /// whatever the clock says, and no line in the report.
  std::optional<std::size_t> replayed_rounds = {};

  /// Whether insertion ends after such a round.
  bool is_vain(const RoundCounts& counts, std::size_t few_seeds, bool is_first) const {
    const std::size_t n_seeds = counts.seeds - (is_first ? std::min(counts.seeds, n_held) : 0);
    return n_seeds > few_seeds && counts.winners < n_seeds / seeds_of_vertex;
  }
};

/// What the passes of a stage have looked at, and what there is left to look at. Work follows damage: a pass
/// looks at cells that are in focus and that, or whose surroundings, have changed since a pass of the same
/// kind last looked at them in this stage. Expects decision values of all cells in the workspace.
class PassState {
 public:
  PassState(Run run, std::string stage);
  PassState(const PassState&) = delete;
  PassState& operator=(const PassState&) = delete;

  /// Cells whose decision value is not positive.
  std::size_t n_invalid() const { return n_invalid_; }
  /// Smallest decision value of the mesh.
  double worst() const { return worst_; }
  /// Whether rounds hold the link condition: no new edge or face can come twice where all cells are positive
  /// and none lie over one another.
  bool checks_links();
  std::size_t n_below(double value);

  /// Forgets what was looked at, so that passes with a wider focus or other operators see every cell again.
  void look_again();
  /// Cells that passes of this kind have to look at; they count as looked at from now on. `pending_bit`: of
  /// Workspace::pending, for a focus on everything.
  Worklist worklist(PassKind kind, std::uint8_t pending_bit, const Focus& focus);
  /// Forgets only what this kind has looked at.
  void look_again_for(PassKind kind) { looked_[static_cast<std::size_t>(kind)] = 0; }
  /// Cells in focus that, or whose surroundings, have changed since the clock stood at `since`.
  Worklist changed_since(std::uint32_t since, const Focus& focus);
  /// Cells whose decision value is below `value`, ascending. Asked again with the same value, it looks only
  /// at what has been written since.
  std::span<const Index> poor(double value);
  /// Brings n_invalid() and worst() up to date. With a focus that holds a cell, both are found inside it.
  void count(const Focus& focus);
  /// The same, where they are known.
  void count_as(std::size_t n_invalid, double worst);
  /// A line in the report, and to the caller that listens.
  void report(const char* op, const Turn& turn, const RoundCounts& counts, double seconds);
  /// Brings the mesh back from the device or other ranks, where passes may have left it.
  void to_host();

  const Run& run() const { return run_; }

 private:
  friend class DevicePasses;
  friend class RankPasses;
  static constexpr auto kKinds = static_cast<std::size_t>(PassKind::kCount);

  Run run_;
  std::string stage_;
  DevicePasses* device_ = nullptr;  // set by itself
  RankPasses* ranks_ = nullptr;     // the same
  std::size_t n_invalid_ = 0;
  double worst_ = 0;
  PoorCells poor_;
  std::array<std::uint32_t, kKinds> looked_{};  // clock at the last look of each kind
};

}  // namespace hfr

#endif
