// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Untangle.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "HalfFace/Layers.hh"
#include "Operators/Unfold.hh"
#include "Parallel/DisjointSets.hh"
#include "Quality/Damage.hh"
#include "Remesh/PassRunner.hh"
#include "Remesh/Survey.hh"
#include "Scheduler/SmoothPass.hh"

namespace hfr {
namespace {

constexpr double kUnfoldNanoseconds = 5'000;  // a vertex

/// Volume of the bounding box, shared out among the cells, times six: the same for any number of threads.
double typical_six_volume(const TetMesh& mesh) {
  if (mesh.n_logical_cells() == 0) return 1.0;
  Vec3 low = mesh.points()[0];
  Vec3 high = low;
  for (Vec3 p : mesh.points()) {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], p[d]);
      high[d] = std::max(high[d], p[d]);
    }
  }
  const Vec3 size = high - low;
  const double volume = 6.0 * size.x * size.y * size.z / static_cast<double>(mesh.n_logical_cells());
  return volume > 0 ? volume : 1.0;
}

/// How tangled the cells are that are worked on.
struct Tangle {
  std::size_t n_invalid = 0;
  double overlap = 0;  // six times the volume of the inverted ones

  /// Fewer cells, or so much less of them that it shows. While vertices find their places, cells become more
  /// at first, and where they are all on their way, fewer only in the end.
  bool is_less_than(const Tangle& other) const {
    return n_invalid < other.n_invalid || overlap * kLargeRise < other.overlap;
  }
};

/// Unfolds the surroundings of invalid cells by moving their vertices. What is moved falls into patches that
/// share no cell; each keeps its moves only if it has fewer invalid cells afterwards, or fewer inverted ones,
/// and none of the two has become more.
class Unfolding {
 public:
  Unfolding(const Run& run, const UntangleEffort& effort)
      : mesh_(run.mesh), work_(run.work), policy_(run.policy()), effort_(effort) {}

  /// Moves what is within so many layers; where that is more than one, vertices may be far from their places,
  /// and begin between their neighbours. Returns what was left in the end, before what does not help was put
  /// back.
  Tangle run(int layers, std::span<const CellHandle> invalid, RunControl& control, RoundCounts& counts) {
    gather(layers, invalid);
    counts.seeds = vertices_.size();
    if (vertices_.empty()) return {invalid.size(), std::numeric_limits<double>::infinity()};
    const StarTable stars(mesh_, vertices_, work_.star_size, policy_);
    const auto groups = colour_vertices(mesh_, vertices_, stars, policy_);
    gather_cells(stars);
    std::vector<Vec3> before(vertices_.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) before[i] = mesh_.point(vertices_[i]);
    // Wider ones go on while that brings anything: what comes from the boundary passes a layer with each.
    const int n_sweeps = layers > 1 ? effort_.iterations * (layers + 1) : effort_.first_sweeps;
    if (layers > 1) relax(stars, groups, layers, control);
    Tangle now = tangle(), least;
    int idle = 0;
    for (int s = 0; s < n_sweeps && now.n_invalid > 0 && idle < effort_.patience && !control.stopped(); ++s) {
      sweep(stars, groups);
      ++counts.rounds;
      now = tangle();
      if (s == 0) least = now;
      idle = s == 0 || now.is_less_than(least) ? 0 : idle + 1;
      least = {std::min(least.n_invalid, now.n_invalid), std::min(least.overlap, now.overlap)};
    }
    counts.winners += keep_what_helps(stars, before);
    return now;
  }

 private:
  /// Vertices of the invalid cells and of so many layers round them, ascending; without those that must stay.
  void gather(int layers, std::span<const CellHandle> invalid) {
    const auto cells_round = [&](std::span<const VertexHandle> rim, auto&& visit) {
      std::vector<VertexHandle> ascending(rim.begin(), rim.end());
      std::sort(ascending.begin(), ascending.end());
      const StarTable stars(mesh_, ascending, work_.star_size, policy_);
      for (std::size_t k = 0; k < stars.size(); ++k)
        for (HalfFaceHandle h : stars.link(k)) visit(cell_of(h));
    };
    const std::vector<std::uint8_t> seen = vertices_within(mesh_, invalid, layers, cells_round);
    vertices_.clear();
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (seen[i] && !work_.frozen[i]) vertices_.push_back(VertexHandle(i));
  }

  /// All cells that a move may change, ascending.
  void gather_cells(const StarTable& stars) {
    std::vector<std::uint8_t> in(mesh_.n_cells(), 0);
    for (std::size_t i = 0; i < stars.size(); ++i)
      for (HalfFaceHandle h : stars.link(i)) in[cell_of(h).idx()] = 1;
    cells_.clear();
    for (std::size_t i = 0; i < in.size(); ++i)
      if (in[i]) cells_.push_back(CellHandle(i));
  }

  Tangle tangle() const {
    std::vector<double> overlaps(cells_.size(), -1);
    par::for_each(policy_, cells_.size(), [&](std::size_t i) {
      const auto& v = mesh_.cell(cells_[i]).v;
      const Vec3 a = mesh_.point(v[0]), b = mesh_.point(v[1]), c = mesh_.point(v[2]), d = mesh_.point(v[3]);
      if (orientation(a, b, c, d) <= 0) overlaps[i] = std::abs(dot(cross(b - a, c - a), d - a));
    });
    Tangle found;
    for (double overlap : overlaps) {  // in a fixed order, since volumes are summed
      if (overlap < 0) continue;
      ++found.n_invalid;
      found.overlap += overlap;
    }
    return found;
  }

  /// Each vertex to the mean of its neighbours, of each as often as they share a cell, by successive
  /// over-relaxation: what the boundary brings goes through all layers in about as many visits as there are
  /// layers, and one takes a tenth of a visit that unfolds. Ends where vertices hardly move any more.
  void relax(const StarTable& stars, const std::vector<std::vector<std::uint32_t>>& groups, int layers,
             RunControl& control) {
    // All but the best for a slab with so many layers on either side of its middle.
    const double over = 2 / (1 + std::numbers::pi / (2 * (layers + 1)));
    std::vector<double> moved(vertices_.size());
    double first = 0;
    for (int s = 0; s < effort_.iterations * (layers + 1) && !control.stopped(); ++s) {
      for (const auto& group : groups)
        par::for_each(policy_, group.size(), [&](std::size_t k) {
          const std::uint32_t i = group[k];
          if (stars.link(i).empty()) return;
          Vec3 sum;
          for (HalfFaceHandle h : stars.link(i))
            for (VertexHandle v : mesh_.halfface_vertices(h)) sum = sum + mesh_.point(v);
          const Vec3 mean = (1.0 / (3.0 * static_cast<double>(stars.link(i).size()))) * sum;
          const Vec3 step = over * (mean - mesh_.point(vertices_[i]));
          mesh_.set_point(vertices_[i], mesh_.point(vertices_[i]) + step);
          moved[i] = norm(step);
        });
      double all = 0;
      for (double one : moved) all += one;  // in a fixed order
      if (s == 0) first = all;
      if (all <= effort_.still * first) return;
    }
  }

  void sweep(const StarTable& stars, const std::vector<std::vector<std::uint32_t>>& groups) {
    for (const auto& group : groups) {
      par::for_each(policy_.for_items_of(kUnfoldNanoseconds), group.size(), [&](std::size_t k) {
        const std::uint32_t i = group[k];
        if (stars.link(i).empty()) return;
        const StarForm form(mesh_, vertices_[i], stars.link(i));
        mesh_.set_point(vertices_[i], mesh_.point(vertices_[i]) + unfold(form, effort_.newton_steps));
      });
    }
  }

  /// Puts the vertices of patches that have not gained back to where they were. Returns the number of moved
  /// vertices that stay.
  std::size_t keep_what_helps(const StarTable& stars, const std::vector<Vec3>& before) {
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
        old[k] = n == kNone ? now[k] : before[n];
        if (n != kNone && patch == kNone) patch = patches.find(n);
      }
      old_damage[patch].add(old[0], old[1], old[2], old[3]);
      new_damage[patch].add(now[0], now[1], now[2], now[3]);
    }
    const auto helps = [&](std::uint32_t patch) {
      const Damage& was = old_damage[patch];
      const Damage& is = new_damage[patch];
      if (!work_.holds_damage) return is.n_invalid() < was.n_invalid();
      return was.may_become(is, work_.floor) &&
             (is.n_invalid() < was.n_invalid() || is.n_inverted() < was.n_inverted());
    };
    std::size_t n_kept = 0;
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
      if (stars.link(i).empty()) continue;
      if (!helps(patches.find(i)))
        mesh_.set_point(vertices_[i],
                        before[i]);  // also where it has moved from 0 to -0, which compare equal
      else if (mesh_.point(vertices_[i]) != before[i])
        ++n_kept;
    }
    return n_kept;
  }

  static constexpr std::uint32_t kNone = 0xffffffffU;
  TetMesh& mesh_;
  Workspace& work_;
  par::Policy policy_;
  const UntangleEffort& effort_;
  std::vector<VertexHandle> vertices_;
  std::vector<CellHandle> cells_;
};

/// Wider and wider until nothing is invalid, or that brings nothing. Returns the number of invalid cells.
std::size_t unfold_by_moving(const Run& run, const UntangleEffort& effort, int iteration) {
  RunControl& control = run.control;
  std::vector<CellHandle> invalid = invalid_cells(run.mesh, run.policy());
  run.keep(invalid.empty());
  Tangle least;
  int idle = 0;
  const auto n_within = [&](int layers) {
    const std::vector<std::uint8_t> within = vertices_within(run.mesh, invalid, layers);
    return static_cast<std::size_t>(std::count(within.begin(), within.end(), 1));
  };
  for (int layers = 1; !invalid.empty() && idle < effort.idle && !control.stopped(); layers += layers + 1) {
    const std::size_t n_reached = n_within(layers);
    if (layers > 1 && n_reached == n_within(layers / 2)) break;  // the mesh ends here
    // Many invalid cells beside one another may hang on what lies as far away as they have come.
    const bool are_many = n_reached < kOneInFew * invalid.size();
    const double start = control.seconds();
    RoundCounts counts;
    const Tangle left = Unfolding(run, effort).run(layers, invalid, control, counts);
    if (counts.winners > 0) ++run.work.clock;
    invalid = invalid_cells(run.mesh, run.policy());
    PassReport pass;
    pass.stage = "untangle";
    pass.op = "unfold";
    pass.iteration = iteration;
    pass.rounds = pass.sub_rounds = counts.rounds;
    pass.seeds = counts.seeds;
    pass.candidates = pass.winners = counts.winners;
    pass.n_inverted = invalid.size();
    pass.worst = survey(run.mesh, run.policy()).worst;
    pass.seconds = pass.seconds_evaluate = control.seconds() - start;
    control.add(std::move(pass));
    control.tell("untangle", iteration, invalid.size(),
                 [&] { return smallest_dihedral(run.mesh, run.policy()); });
    const bool has_brought = layers == 1 || left.is_less_than(least);
    if (has_brought) least = left;
    idle = has_brought || are_many ? 0 : idle + 1;
  }
  return invalid.size();
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
  const Untangling metric{1.0 / typical_six_volume(run.mesh),
                          run.work.holds_damage ? run.work.floor : kNoFloor};
  // Moving comes first: connectivity that was right before the mesh moved is worth keeping.
  const auto move = [&](int iteration) {
    return moves ? unfold_by_moving(run, effort, iteration) : invalid_cells(run.mesh, run.policy()).size();
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
