// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <numeric>

#include "Operators/Unfold.hh"
#include "Quality/Damage.hh"
#include "Remesh/Pipeline.hh"
#include "Remesh/Stage.hh"

namespace hfr {
namespace {

/// Focus of the untangling stage, as decision values of volume-length: from what is all but flat to what is
/// merely poor. Wider only when the narrower one has stopped helping.
constexpr std::array<double, 4> kUntangleFocus = {1e-4, 1e-2, 0.1, 0.3};
constexpr int kMaxUntangleIterations = 40;
constexpr int kMaxIdle = 2;
constexpr int kMaxRestarts = 6;  // of reconnection after moving
/// Layers of cells round the inverted ones whose vertices are unfolded together, and how often each vertex
/// is visited.
struct Width {
  int layers;
  int sweeps;
};
constexpr std::array<Width, 3> kWidths = {{{1, 6}, {3, 12}, {7, 24}}};
constexpr int kNewtonSteps = 3;
constexpr double kUnfoldNanoseconds = 5'000;  // a vertex
constexpr int kPatience = 4;                  // sweeps without fewer inverted cells

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

/// Unfolds the surroundings of invalid cells by moving their vertices. What is moved falls into patches that
/// share no cell; each keeps its moves only if it has fewer invalid cells afterwards, or fewer inverted ones,
/// and none of the two has become more.
class Unfolding {
 public:
  Unfolding(TetMesh& mesh, Workspace& work, par::Policy policy) : mesh_(mesh), work_(work), policy_(policy) {}

  void run(Width width, std::span<const CellHandle> invalid, RunControl& control, RoundCounts& counts) {
    gather(width.layers, invalid);
    counts.seeds = vertices_.size();
    if (vertices_.empty()) return;
    const StarTable stars(mesh_, vertices_, work_.star_size, policy_);
    const auto groups = colour_vertices(mesh_, vertices_, stars, policy_);
    gather_cells(stars);
    std::vector<Vec3> before(vertices_.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) before[i] = mesh_.point(vertices_[i]);
    std::size_t least = n_set(invalidity());
    std::size_t n_invalid = least;
    int idle = 0;
    for (int s = 0; s < width.sweeps && n_invalid > 0 && idle < kPatience && !control.stopped(); ++s) {
      sweep(stars, groups);
      ++counts.rounds;
      n_invalid = n_set(invalidity());
      idle = n_invalid < least ? 0 : idle + 1;
      least = std::min(least, n_invalid);
    }
    counts.winners += keep_what_helps(stars, before);
  }

 private:
  static std::size_t n_set(const std::vector<std::uint8_t>& flags) {
    return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
  }

  /// Vertices of the invalid cells and of so many layers round them, ascending; without those that must stay.
  void gather(int layers, std::span<const CellHandle> invalid) {
    std::vector<std::uint8_t> seen(mesh_.n_vertices(), 0);
    std::vector<VertexHandle> rim, next;
    const auto see = [&](CellHandle c) {
      for (VertexHandle v : mesh_.cell(c).v) {
        if (seen[v.idx()]) continue;
        seen[v.idx()] = 1;
        next.push_back(v);
      }
    };
    for (CellHandle c : invalid) see(c);
    for (int i = 0; i < layers; ++i) {
      rim.swap(next);
      next.clear();
      std::sort(rim.begin(), rim.end());
      const StarTable stars(mesh_, rim, work_.star_size, policy_);
      for (std::size_t k = 0; k < stars.size(); ++k)
        for (HalfFaceHandle h : stars.link(k)) see(cell_of(h));
    }
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

  std::vector<std::uint8_t> invalidity() const {
    std::vector<std::uint8_t> flags(cells_.size(), 0);
    par::for_each(policy_, cells_.size(), [&](std::size_t i) {
      const auto& v = mesh_.cell(cells_[i]).v;
      flags[i] = orientation(mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), mesh_.point(v[3])) <= 0
                     ? 1
                     : 0;
    });
    return flags;
  }

  void sweep(const StarTable& stars, const std::vector<std::vector<std::uint32_t>>& groups) {
    for (const auto& group : groups) {
      par::for_each(policy_.for_items_of(kUnfoldNanoseconds), group.size(), [&](std::size_t k) {
        const std::uint32_t i = group[k];
        if (stars.link(i).empty()) return;
        const StarForm form(mesh_, vertices_[i], stars.link(i));
        mesh_.set_point(vertices_[i], mesh_.point(vertices_[i]) + unfold(form, kNewtonSteps));
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
    std::vector<std::uint32_t> parent(vertices_.size());
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](std::uint32_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (CellHandle c : cells_) {
      std::uint32_t first = kNone;
      for (VertexHandle v : mesh_.cell(c).v) {
        if (number[v.idx()] == kNone) continue;
        const std::uint32_t r = root(number[v.idx()]);
        if (first != kNone && r != first) parent[std::max(r, first)] = std::min(r, first);
        first = first == kNone ? r : std::min(r, first);
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
        if (n != kNone && patch == kNone) patch = root(n);
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
      if (!helps(root(i)))
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
  std::vector<VertexHandle> vertices_;
  std::vector<CellHandle> cells_;
};

/// Wider and wider until nothing is invalid. Returns the number of cells that are.
std::size_t unfold_by_moving(TetMesh& mesh, Workspace& work, const ImproveOptions& options,
                             RunControl& control, int iteration) {
  std::vector<CellHandle> invalid = invalid_cells(mesh, options.policy);
  control.keep(mesh, invalid.empty());
  for (const Width& width : kWidths) {
    if (invalid.empty() || control.stopped()) break;
    const double start = control.seconds();
    RoundCounts counts;
    Unfolding(mesh, work, options.policy).run(width, invalid, control, counts);
    if (counts.winners > 0) ++work.clock;
    invalid = invalid_cells(mesh, options.policy);
    PassReport pass;
    pass.stage = "untangle";
    pass.op = "unfold";
    pass.iteration = iteration;
    pass.rounds = pass.sub_rounds = counts.rounds;
    pass.seeds = counts.seeds;
    pass.candidates = pass.winners = counts.winners;
    pass.n_inverted = invalid.size();
    pass.worst = survey(mesh, options.policy).worst;
    pass.seconds = pass.seconds_evaluate = control.seconds() - start;
    control.add(std::move(pass));
    if (options.progress)
      options.progress({"untangle", iteration, control.fraction(), invalid.size(),
                        smallest_dihedral(mesh, options.policy)});
  }
  return invalid.size();
}

}  // namespace

void untangle(TetMesh& mesh, Workspace& work, const ImproveOptions& options, RunControl& control) {
  const bool moves = has(options.ops, Ops::kSmooth);
  const Untangling metric{1.0 / typical_six_volume(mesh), work.holds_damage ? work.floor : kNoFloor};
  // Moving comes first: connectivity that was right before the mesh moved is worth keeping.
  if (moves && unfold_by_moving(mesh, work, options, control, 1) == 0) return;
  for (int restart = 1; restart <= kMaxRestarts && !control.stopped(); ++restart) {
    Stage<Untangling> stage(mesh, work, options, control, metric, "untangle");
    const std::size_t n_at_start = stage.n_invalid();
    std::size_t level = 0;
    std::size_t n_invalid = n_at_start;
    double worst = stage.worst();
    int idle = 0;
    for (int i = 1; i <= kMaxUntangleIterations && stage.n_invalid() > 0 && !control.stopped(); ++i) {
      const Focus focus{kUntangleFocus[level]};
      std::size_t changes = moves ? stage.smooth_pass(i, focus) : 0;
      if (stage.n_invalid() == 0) break;
      changes += stage.iterate(i, focus, true);
      const bool better = stage.n_invalid() < n_invalid || stage.worst() > worst;
      idle = better ? 0 : idle + 1;
      n_invalid = stage.n_invalid();
      worst = stage.worst();
      // A wide focus makes room, and what has room is better moved.
      if (changes > 0 && idle < kMaxIdle) continue;
      if (++level == kUntangleFocus.size()) break;
      stage.look_again();
      idle = 0;
    }
    if (stage.n_invalid() > 0 && has(options.ops, Ops::kCluster))
      stage.cluster_pass(restart, Focus{kUntangleFocus[0]});
    if (stage.n_invalid() > 0 && has(options.ops, Ops::kInsert))
      stage.insert_pass(restart, Focus{kUntangleFocus[0]});
    if (stage.n_invalid() == 0) return;
    const std::size_t left =
        moves ? unfold_by_moving(mesh, work, options, control, 1 + restart) : stage.n_invalid();
    if (left == 0 || left >= n_at_start) return;
  }
}

}  // namespace hfr
