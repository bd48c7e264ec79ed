// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_WORKSPACE_HH
#define HFR_SCHEDULER_WORKSPACE_HH

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Operators/Operator.hh"
#include "hfremesh/Parallel/Parallel.hh"
#include "hfremesh/Quality/CellQuality.hh"
#include "hfremesh/Quality/Decisions.hh"
#include "hfremesh/Quality/Metrics.hh"

namespace hfr {

/// What a cell that nobody holds has in the array of claims.
inline constexpr std::uint32_t kUnclaimed = 0xffffffffU;

/// What rounds keep about the mesh between them: 13 bytes a cell, 9 a vertex, and one more where some vertex
/// is pinched.
struct Workspace {
  std::vector<double> quality;        ///< per cell slot: decision value in the metric of the stage
  std::vector<std::uint32_t> claim;   ///< per cell slot: the winner that holds it in this round; see select()
  std::vector<std::uint8_t> pending;  ///< per cell slot: one bit an operator that has not looked at it yet
  std::vector<std::uint8_t> frozen;   ///< per vertex; see constrained_vertices()
  std::vector<std::uint32_t> star_size;  ///< per vertex: number of its cells
  std::vector<std::uint32_t> changed;    ///< per vertex: clock of the last change of its star
  /// Per vertex: 1 where a walk round it misses some of its cells (see is_pinched()); empty when there is no
  /// such vertex. Rounds make none.
  std::vector<std::uint8_t> pinched;
  /// Decision value of MinDihedral of the worst cell with which the run began, where that had inverted or
  /// flat cells: no cluster of such cells may come to be worse. attach() leaves it alone.
  double floor = kNoFloor;
  /// Whether each cluster is held to what hfr_damage_may_become() allows, and not only to no more cells that
  /// the metric calls invalid: then whoever runs the rounds looks at the mesh as a whole in the end.
  bool holds_damage = true;
  /// The metric whose decision values `quality` has, of every live cell as it is. Rounds and smoothing passes
  /// keep them right; whoever changes the mesh by other means calls forget_qualities().
  enum class QualitiesOf : std::uint8_t { kAnother, kMinSine2, kMinDihedral };
  QualitiesOf qualities_of = QualitiesOf::kAnother;
  std::uint32_t clock = 1;     ///< counts rounds
  std::vector<Index> touched;  ///< cell slots written since clear_touched(), some more than once
  bool all_touched = true;     ///< more than are worth a list

  /// Forgets the run before, but for what is known of vertices.
  void begin() {
    floor = kNoFloor;
    holds_damage = true;
    forget_qualities();
    clock = 1;
    clear_touched();
    all_touched = true;
  }

  /// Sizes everything for the mesh, all cells pending. Qualities are left to set_qualities().
  void attach(const TetMesh& mesh, par::Policy policy) {
    forget_qualities();
    find_stars(mesh, policy);
    attach_again(mesh, policy);
  }

  /// Of all vertices what goes by the cells round them.
  void find_stars(const TetMesh& mesh, par::Policy policy) {
    star_size = star_sizes(mesh, policy);
    pinched = pinched_vertices(mesh, star_size, policy);
  }

  /// The same as attach() where star_size and pinched are those of the mesh already, and so are qualities
  /// that are not forgotten.
  void attach_again(const TetMesh& mesh, par::Policy policy) {
    const std::size_t room = room_for(mesh);
    quality.reserve(room);
    claim.reserve(room);
    pending.reserve(room);
    quality.resize(mesh.n_cells(), 0.0);
    claim.assign(mesh.n_cells(), kUnclaimed);
    pending.assign(mesh.n_cells(), 0xff);
    frozen = constrained_vertices(mesh, policy);
    changed.assign(mesh.n_vertices(), clock);
  }

  /// After garbage was collected, before the next run: qualities follow, and what goes with vertices alone.
  void follow(const GarbageMap& garbage) {
    close_gaps(garbage.vertices, star_size);
    close_gaps(garbage.vertices, frozen);
    close_gaps(garbage.vertices, pinched);
    if (qualities_of != QualitiesOf::kAnother) close_gaps(garbage.cells, quality);
  }

  /// Qualities follow cells that were given another order: each has gone to `to`.
  void follow_order(const std::vector<CellHandle>& to) {
    if (qualities_of == QualitiesOf::kAnother) return;
    std::vector<double> now(quality.size());
    for (std::size_t i = 0; i < to.size(); ++i) now[to[i].idx()] = quality[i];
    quality.swap(now);
  }

  /// Brings `pinched` up to date for these vertices, whose star sizes are right.
  void look_for_pinched(const TetMesh& mesh, std::span<const VertexHandle> vertices) {
    Star scratch;
    for (VertexHandle v : vertices) {
      const std::uint32_t size = star_size[v.idx()];
      const bool is_one = size > 0 && is_pinched(mesh, v, size, scratch);
      if (is_one && pinched.empty()) pinched.assign(mesh.n_vertices(), 0);
      if (!pinched.empty()) pinched[v.idx()] = is_one ? 1 : 0;
    }
    if (std::count(pinched.begin(), pinched.end(), 1) == 0) pinched.clear();
  }
  /// Brings `pinched` up to date where rounds leave it behind: one that was pinched may no longer be, and a
  /// star may have outgrown Star.
  void look_again_for_pinched(const TetMesh& mesh, par::Policy policy) {
    const auto asks = [&](std::size_t v) {
      return star_size[v] > static_cast<std::uint32_t>(Star::kCapacity) ||
             (!pinched.empty() && pinched[v] != 0);
    };
    std::vector<VertexHandle> vertices;
    for (Index v : par::compact<Index>(policy, star_size.size(), asks)) vertices.push_back(VertexHandle(v));
    look_for_pinched(mesh, vertices);
  }

  /// Slots for the cells of the mesh and those that rounds may put in, as the mesh has.
  static std::size_t room_for(const TetMesh& mesh) { return mesh.n_cells() + mesh.n_cells() / 16; }

  /// Follows the mesh after it has grown.
  void grow(const TetMesh& mesh) {
    quality.resize(mesh.n_cells(), 0.0);
    claim.resize(mesh.n_cells(), kUnclaimed);
    pending.resize(mesh.n_cells(), 0);
    frozen.resize(mesh.n_vertices(), 0);
    star_size.resize(mesh.n_vertices(), 0);
    changed.resize(mesh.n_vertices(), clock);
    if (!pinched.empty()) pinched.resize(mesh.n_vertices(), 0);
  }

  /// True when an edge between vertices of these cells may exist although no cell near them has it, even
  /// where all cells are positive: two parts of the mesh that lie over one another may share both its ends.
  bool has_two_pinched(const TetMesh& mesh, std::span<const CellHandle> cells) const {
    if (pinched.empty()) return false;
    VertexHandle first;
    for (CellHandle c : cells)
      for (VertexHandle v : mesh.cell(c).v) {
        if (!pinched[v.idx()] || v == first) continue;
        if (first.is_valid()) return true;
        first = v;
      }
    return false;
  }

  /// `to`: from collect_garbage(); empty where nothing goes.
  template <class H, class T>
  static void close_gaps(const std::vector<H>& to, std::vector<T>& values) {
    if (values.empty() || to.empty()) return;
    std::size_t n = 0;
    for (std::size_t i = 0; i < to.size(); ++i)
      if (to[i].is_valid()) values[n++] = values[i];
    values.resize(n);
  }

  void touch(std::span<const CellHandle> cells) {
    if (all_touched || touched.size() + cells.size() > quality.size() / 8) {
      all_touched = true;
      return;
    }
    for (CellHandle c : cells) touched.push_back(c.idx());
  }
  void clear_touched() {
    touched.clear();
    all_touched = false;
  }

  /// Decision value of every live cell; +infinity in deleted slots.
  template <class Metric>
  void set_qualities(const TetMesh& mesh, const Metric& metric, par::Policy policy) {
    if (quality.capacity() < mesh.n_cells()) quality.reserve(room_for(mesh));
    quality.resize(mesh.n_cells());
    par::for_ranges(policy, mesh.n_cells(), [&](std::size_t begin, std::size_t end) {
      for_decisions(mesh, metric, begin, end, [&](std::size_t i, double value) { quality[i] = value; });
    });
    qualities_of = kQualitiesOf<Metric>;
  }
  /// Whether set_qualities() would change nothing. False for metrics that are not told apart.
  template <class Metric>
  bool has_qualities_of() const {
    return qualities_of != QualitiesOf::kAnother && qualities_of == kQualitiesOf<Metric>;
  }
  void forget_qualities() { qualities_of = QualitiesOf::kAnother; }
  /// Brings those of these cells up to date, which others have changed; nothing where they are of a metric
  /// that is not told apart.
  void renew_qualities(const TetMesh& mesh, std::span<const CellHandle> cells, par::Policy policy) {
    const auto in = [&](const auto& metric) {
      par::for_each(policy, cells.size(), [&](std::size_t i) {
        quality[cells[i].idx()] = mesh.is_deleted(cells[i]) ? std::numeric_limits<double>::infinity()
                                                            : hfr::quality(mesh, cells[i], metric);
      });
    };
    if (has_qualities_of<MinSine2>()) in(MinSine2{});
    if (has_qualities_of<MinDihedral>()) in(MinDihedral{});
  }

  template <class Metric>
  static constexpr QualitiesOf kQualitiesOf =
      std::is_same_v<Metric, MinSine2>      ? QualitiesOf::kMinSine2
      : std::is_same_v<Metric, MinDihedral> ? QualitiesOf::kMinDihedral
                                            : QualitiesOf::kAnother;
};

/// What a round or a pass did.
struct RoundCounts {
  std::size_t rounds = 0;
  std::size_t seeds = 0;       ///< looked at
  std::size_t candidates = 0;  ///< that would improve their cluster
  std::size_t winners = 0;     ///< committed
  std::size_t held_back = 0;   ///< that would be winners but for RoundOptions::may_lose and may_gain
  std::size_t sub_rounds = 0;  ///< of the selection: 1 a round when it is one marking loop
  double seconds_evaluate = 0;
  double seconds_select = 0;
  double seconds_commit = 0;

  RoundCounts& operator+=(const RoundCounts& o) {
    rounds += o.rounds;
    seeds += o.seeds;
    candidates += o.candidates;
    winners += o.winners;
    held_back += o.held_back;
    sub_rounds += o.sub_rounds;
    seconds_evaluate += o.seconds_evaluate;
    seconds_select += o.seconds_select;
    seconds_commit += o.seconds_commit;
    return *this;
  }
};

}  // namespace hfr

#endif
