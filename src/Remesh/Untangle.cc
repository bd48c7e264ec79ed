// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Untangle.hh"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "HalfFace/Layers.hh"
#include "Parallel/DisjointSets.hh"
#include "Quality/Damage.hh"
#include "Remesh/PassRunner.hh"
#include "Remesh/Survey.hh"
#include "Remesh/Unfolding.hh"
#include "Scheduler/StarTable.hh"
#include "Scheduler/VertexColours.hh"

namespace hfr {
namespace {

/// Volume of the bounding box, shared out among the cells, times six: the same for any number of threads.
double typical_six_volume(const Run& run) {
  if (run.n_cells() == 0) return 1.0;
  const Box box = run.is_part() ? run.parts()->box() : box_of(run.mesh);
  const Vec3 size = box.high - box.low;
  const double volume = 6.0 * size.x * size.y * size.z / static_cast<double>(run.n_cells());
  return volume > 0 ? volume : 1.0;
}

/// In a mesh that is all there is.
class MeshUnfolding : public Unfolding {
 public:
  MeshUnfolding(const Run& run, const UntangleEffort& effort)
      : mesh_(run.mesh), work_(run.work), policy_(run.policy()), effort_(effort) {}

  std::size_t look() override {
    invalid_ = invalid_cells(mesh_, policy_, known_values(work_));
    return invalid_.size();
  }

  std::size_t n_within(int layers) override {
    const std::vector<std::uint8_t> within = vertices_within(mesh_, invalid_, layers);
    return static_cast<std::size_t>(std::count(within.begin(), within.end(), 1));
  }

  std::size_t take(int layers) override {
    gather(layers);
    if (vertices_.empty()) return 0;
    stars_ = StarTable(mesh_, vertices_, work_.star_size, policy_);
    groups_ = colour_vertices(mesh_, vertices_, stars_, policy_);
    gather_cells();
    before_.resize(vertices_.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) before_[i] = mesh_.point(vertices_[i]);
    return vertices_.size();
  }

  Tangle tangle() override {
    std::vector<double> overlaps(cells_.size());
    par::for_each(policy_, cells_.size(), [&](std::size_t i) { overlaps[i] = overlap_of(mesh_, cells_[i]); });
    Tangle found;
    for (double overlap : overlaps) {  // in a fixed order, since volumes are summed
      if (overlap < 0) continue;
      ++found.n_invalid;
      found.overlap += overlap;
    }
    return found;
  }

  double relax(double over) override {
    std::vector<double> moved(vertices_.size());
    for (const auto& group : groups_)
      par::for_each(policy_, group.size(), [&](std::size_t k) {
        const std::uint32_t i = group[k];
        if (stars_.link(i).empty()) return;
        const Vec3 step = relaxation(mesh_, vertices_[i], stars_.link(i), over);
        mesh_.set_point(vertices_[i], mesh_.point(vertices_[i]) + step);
        moved[i] = norm(step);
      });
    double all = 0;
    for (double one : moved) all += one;  // in a fixed order
    return all;
  }

  void put_back() override {
    for (std::size_t i = 0; i < vertices_.size(); ++i)
      if (!stars_.link(i).empty()) mesh_.set_point(vertices_[i], before_[i]);
  }

  void sweep() override {
    for (const auto& group : groups_) {
      par::for_each(policy_.for_items_of(kUnfoldNanoseconds), group.size(), [&](std::size_t k) {
        const std::uint32_t i = group[k];
        if (stars_.link(i).empty()) return;
        mesh_.set_point(vertices_[i], unfolded(mesh_, vertices_[i], stars_.link(i), effort_));
      });
    }
  }

  std::size_t keep_what_helps() override {
    // Patches: moved vertices that share a cell, joined under the smallest of them.
    std::vector<std::uint32_t> number(mesh_.n_vertices(), kNone);
    for (std::size_t i = 0; i < vertices_.size(); ++i)
      number[vertices_[i].idx()] = static_cast<std::uint32_t>(i);
    par::DisjointSets<std::uint32_t> patches(vertices_.size());
    for (CellHandle c : cells_) {
      std::uint32_t first = kNone;
      for (VertexHandle v : mesh_.cell(c).v) {
        const std::uint32_t n = number[v.idx()];
        if (n == kNone) continue;
        if (first != kNone) patches.join(first, n);
        first = n;
      }
    }
    std::vector<Damage> old_damage(vertices_.size()), new_damage(vertices_.size());
    for (CellHandle c : cells_) {  // in a fixed order, since volumes are summed
      const auto& v = mesh_.cell(c).v;
      std::array<Vec3, 4> now, old;
      std::uint32_t patch = kNone;
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t n = number[v[k].idx()];
        now[k] = mesh_.point(v[k]);
        old[k] = n == kNone ? now[k] : before_[n];
        if (n != kNone && patch == kNone) patch = patches.find(n);
      }
      old_damage[patch].add(old[0], old[1], old[2], old[3]);
      new_damage[patch].add(now[0], now[1], now[2], now[3]);
    }
    std::size_t n_kept = 0;
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
      if (stars_.link(i).empty()) continue;
      if (!helps(work_, old_damage[patches.find(i)], new_damage[patches.find(i)]))
        mesh_.set_point(vertices_[i],
                        before_[i]);  // also where it has moved from 0 to -0, which compare equal
      else if (mesh_.point(vertices_[i]) != before_[i])
        ++n_kept;
    }
    work_.renew_qualities(mesh_, cells_, policy_);
    return n_kept;
  }

 private:
  /// Vertices of the invalid cells and of so many layers round them, ascending; without those that must stay.
  void gather(int layers) {
    const auto cells_round = [&](std::span<const VertexHandle> rim, auto&& visit) {
      std::vector<VertexHandle> ascending(rim.begin(), rim.end());
      std::sort(ascending.begin(), ascending.end());
      const StarTable stars(mesh_, ascending, work_.star_size, policy_);
      for (std::size_t k = 0; k < stars.size(); ++k)
        for (HalfFaceHandle h : stars.link(k)) visit(cell_of(h));
    };
    const std::vector<std::uint8_t> seen = vertices_within(mesh_, invalid_, layers, cells_round);
    vertices_.clear();
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (seen[i] && !work_.frozen[i]) vertices_.push_back(VertexHandle(i));
  }

  /// All cells that a move may change, ascending.
  void gather_cells() {
    std::vector<std::uint8_t> in(mesh_.n_cells(), 0);
    for (std::size_t i = 0; i < stars_.size(); ++i)
      for (HalfFaceHandle h : stars_.link(i)) in[cell_of(h).idx()] = 1;
    cells_.clear();
    for (std::size_t i = 0; i < in.size(); ++i)
      if (in[i]) cells_.push_back(CellHandle(i));
  }

  static constexpr std::uint32_t kNone = 0xffffffffU;
  TetMesh& mesh_;
  Workspace& work_;
  par::Policy policy_;
  const UntangleEffort& effort_;
  std::vector<CellHandle> invalid_;
  std::vector<VertexHandle> vertices_;  // that are moved
  StarTable stars_;                     // of these, as the groups of one colour and the points before
  std::vector<std::vector<std::uint32_t>> groups_;
  std::vector<Vec3> before_;
  std::vector<CellHandle> cells_;  // that a move may change
};

/// By successive over-relaxation: what the boundary brings goes through all layers in about as many visits as
/// there are layers, and one takes a tenth of a visit that unfolds. Ends where vertices hardly move any more.
void relax(Unfolding& unfolding, const UntangleEffort& effort, int layers, RunControl& control) {
  // All but the best for a slab with so many layers on either side of its middle.
  const double over = 2 / (1 + std::numbers::pi / (2 * (layers + 1)));
  double first = 0;
  for (int s = 0; s < effort.iterations * (layers + 1) && !control.stopped(); ++s) {
    const double all = unfolding.relax(over);
    if (s == 0) first = all;
    if (all <= effort.still * first) return;
  }
}

/// Whether hardly any of the invalid cells are left: what is moved is too much for them.
bool are_few(std::size_t n_invalid, std::size_t of) { return n_invalid <= of / kOneInFew; }

/// Moves what is within so many layers. Where that is more than one, vertices may be far from their places,
/// and begin between their neighbours if that leaves less of the inverted cells; not where they have been
/// moved before (`again`). Returns what was left in the end, before what does not help was put back.
Tangle unfold_within(Unfolding& unfolding, const UntangleEffort& effort, int layers, bool again,
                     std::size_t n_invalid, RunControl& control, RoundCounts& counts) {
  counts.seeds = unfolding.take(layers);
  if (counts.seeds == 0) return {n_invalid, std::numeric_limits<double>::infinity()};
  // Wider ones go on while that brings anything: what comes from the boundary passes a layer with each.
  const int n_sweeps = layers > 1 ? effort.iterations * (layers + 1) : effort.first_sweeps;
  Tangle now = unfolding.tangle(), least;
  if (layers > 1 && !again) {
    const Tangle before = now;
    relax(unfolding, effort, layers, control);
    now = unfolding.tangle();
    if (!(now.overlap < before.overlap)) {
      unfolding.put_back();
      now = before;
    }
  }
  int idle = 0;
  for (int s = 0; s < n_sweeps && !are_few(now.n_invalid, n_invalid) && idle < effort.patience; ++s) {
    if (control.stopped()) break;
    unfolding.sweep();
    ++counts.rounds;
    now = unfolding.tangle();
    if (s == 0) least = now;
    idle = s == 0 || now.is_less_than(least) ? 0 : idle + 1;
    least = {std::min(least.n_invalid, now.n_invalid), std::min(least.overlap, now.overlap)};
  }
  counts.winners += unfolding.keep_what_helps();
  return now;
}

/// Wider and wider until nothing is invalid, or that brings nothing; where hardly any are left, what lies
/// round these again. Returns the number of invalid cells.
std::size_t unfold_by_moving(const Run& run, const UntangleEffort& effort, int iteration) {
  RunControl& control = run.control;
  const std::unique_ptr<Unfolding> unfolding =
      run.is_part() ? run.parts()->unfolding(effort) : std::make_unique<MeshUnfolding>(run, effort);
  std::size_t n_invalid = unfolding->look();
  if (n_invalid > 0) run.findings.may_cover_twice = true;
  run.keep(n_invalid == 0);
  Tangle least;
  bool again = false;
  int idle = 0;
  for (int layers = 1; n_invalid > 0 && idle < effort.idle && !control.stopped();
       layers += again ? 0 : layers + 1) {
    const std::size_t n_reached = unfolding->n_within(layers);
    if (layers > 1 && !again && n_reached == unfolding->n_within(layers / 2)) break;  // the mesh ends here
    // Many invalid cells beside one another may hang on what lies as far away as they have come.
    const bool are_many = n_reached < kOneInFew * n_invalid;
    const double start = control.seconds();
    RoundCounts counts;
    const std::size_t n_before = n_invalid;
    const Tangle left = unfold_within(*unfolding, effort, layers, again, n_invalid, control, counts);
    if (counts.winners > 0) ++run.work.clock;
    n_invalid = unfolding->look();
    again = are_few(n_invalid, n_before);
    PassReport pass;
    pass.stage = "untangle";
    pass.op = "unfold";
    pass.iteration = iteration;
    pass.rounds = pass.sub_rounds = counts.rounds;
    pass.seeds = counts.seeds;
    pass.candidates = pass.winners = counts.winners;
    pass.n_inverted = n_invalid;
    pass.worst = run.survey().worst;
    pass.seconds = pass.seconds_evaluate = control.seconds() - start;
    control.add(std::move(pass));
    control.tell("untangle", iteration, n_invalid, [&] { return run.smallest_dihedral(); });
    const bool has_brought = layers == 1 || again || left.is_less_than(least);
    if (has_brought) least = left;
    idle = has_brought || are_many ? 0 : idle + 1;
  }
  return n_invalid;
}

/// Iterates on what is invalid, the focus widening while it helps.
void reconnect(PassRunner<Untangling>& runner, const Run& run, const UntangleEffort& effort) {
  std::size_t level = 0;
  std::size_t n_invalid = runner.n_invalid();
  double worst = runner.worst();
  int idle = 0;
  for (int i = 1; i <= effort.iterations && runner.n_invalid() > 0 && !run.control.stopped(); ++i) {
    const Turn turn{i, Focus{effort.focus[level]}};
    std::size_t changes = runner.pass(PassKind::kSmooth, turn);
    if (runner.n_invalid() == 0) break;
    changes += runner.iterate(turn);
    const bool better = runner.n_invalid() < n_invalid || runner.worst() > worst;
    idle = better ? 0 : idle + 1;
    n_invalid = runner.n_invalid();
    worst = runner.worst();
    // A wide focus makes room, and what has room is better moved.
    if (changes > 0 && idle < effort.idle) continue;
    if (++level == effort.focus.size()) break;
    runner.look_again();
    idle = 0;
  }
}

}  // namespace

bool untangle(const Run& run, const UntangleEffort& effort) {
  const bool moves = has(run.strategy.pass.ops, Ops::kSmooth);
  const Untangling metric{1.0 / typical_six_volume(run), run.work.holds_damage ? run.work.floor : kNoFloor};
  // Moving comes first: connectivity that was right before the mesh moved is worth keeping.
  const auto move = [&](int iteration) {
    return moves ? unfold_by_moving(run, effort, iteration) : run.survey().n_invalid;
  };
  std::size_t n_left = move(1);
  if (moves && n_left == 0) return true;
  // Each restart leaves fewer invalid cells than the one before, or is the last. The runner's count is not
  // asked: a cell that is flat but for rounding may be invalid in its metric only.
  for (int restart = 1; !run.control.stopped(); ++restart) {
    PassRunner<Untangling> runner(run, metric, "untangle");
    reconnect(runner, run, effort);
    const Turn last{restart, Focus{effort.focus[0]}};
    if (runner.n_invalid() > 0) runner.pass(PassKind::kCluster, last);
    if (runner.n_invalid() > 0) runner.pass(PassKind::kInsert, last);
    if (runner.n_invalid() == 0) return false;
    const std::size_t n_before = std::exchange(n_left, move(1 + restart));
    if (n_left == 0 || n_left >= n_before) return n_left == 0;
  }
  return false;
}

}  // namespace hfr
