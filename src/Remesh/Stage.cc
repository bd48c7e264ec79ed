// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Stage.hh"

#include <algorithm>

#include "Remesh/Pipeline.hh"

namespace hfr {
namespace {

constexpr std::size_t kSearchPoints = 14;  // of a cavity whose fillings are searched
constexpr std::size_t kSearchNodes = 300;  // of each search: more found little more on the test meshes
constexpr int kMaxRounds = 12;             // of one operator in one pass
constexpr int kMaxInsertRounds = 200;      // of insertion, which takes seeds that lie apart
// Where more cells than this wait for a vertex, only the most promising places are followed up for each:
// three find the same as all on the test meshes, in half the time; for the last ones each place counts.
constexpr std::size_t kFewSeeds = 64;
constexpr std::size_t kSitesOfMany = 3;
// With a frozen surface nearly half of them have no place of such promise, and one in twelve of these a plan.
constexpr double kPromiseOfMany = 0.5;
constexpr std::size_t kLeastRoom = 4;  // cells that a new vertex takes, about
constexpr std::size_t kLittle = 200;   // stop when a round commits less than 1/kLittle of the first one

}  // namespace

template <class Metric>
std::span<const Index> Stage<Metric>::poor(double value) {
  to_host();
  const auto& quality = work_.quality;
  if (work_.all_touched || value != poor_below_) {
    poor_ = par::compact<Index>(options_.policy, quality.size(),
                                [&](std::size_t i) { return quality[i] < value; });
  } else if (!work_.touched.empty()) {
    std::erase_if(poor_, [&](Index c) { return !(quality[c] < value); });
    const auto n_old = static_cast<std::ptrdiff_t>(poor_.size());
    for (Index c : work_.touched)
      if (quality[c] < value) poor_.push_back(c);
    std::sort(poor_.begin() + n_old, poor_.end());
    std::inplace_merge(poor_.begin(), poor_.begin() + n_old, poor_.end());
    poor_.erase(std::unique(poor_.begin(), poor_.end()), poor_.end());
  }
  poor_below_ = value;
  work_.clear_touched();
  return poor_;
}

template <class Metric>
void Stage<Metric>::count(Focus focus) {
  to_host();
  struct Sum {
    std::size_t invalid = 0;
    double worst = std::numeric_limits<double>::infinity();
  };
  const auto& quality = work_.quality;
  const auto sum_over = [&](std::size_t n, auto&& cell) {
    return par::reduce(
        options_.policy, n, Sum{},
        [&](std::size_t i) {
          const double q = quality[cell(i)];
          return Sum{static_cast<std::size_t>(q > 0 ? 0 : 1), q};
        },
        [](Sum a, Sum b) {
          return Sum{a.invalid + b.invalid, std::min(a.worst, b.worst)};
        });
  };
  Sum sum;
  if (!focus.everything() && focus.below > 0) {
    const auto cells = poor(focus.below);
    sum = sum_over(cells.size(), [&](std::size_t i) { return cells[i]; });
  }
  if (!(sum.worst < focus.below)) sum = sum_over(quality.size(), [](std::size_t i) { return i; });
  n_invalid_ = sum.invalid;
  worst_ = sum.worst;
}

template <class Metric>
template <class MakeOp, class RunRound>
std::size_t Stage<Metric>::rounds(Kind kind, int iteration, Focus focus, MakeOp&& make_op,
                                  RunRound&& run_round) {
  const double start = control_.seconds();
  RoundCounts total;
  std::size_t first = 0;
  using Op = decltype(make_op());
  const int limit = replay_ ? static_cast<int>(*replay_) : kind == kInsert ? kMaxInsertRounds : kMaxRounds;
  for (int r = 0; r < limit && (replay_ || !control_.stopped()); ++r) {
    const Worklist list = worklist(kind, focus);
    if (list.cells().empty() && !(kind == kInsert && !waiting_.empty())) break;
    RoundOptions round_options{options_.policy, n_invalid_ > 0 || control_.is_folded(), options_.seed,
                               options_.compat == Compat::kJpdc2013};
    const std::size_t n_cells = mesh_.n_logical_cells();
    round_options.may_lose = may_lose(n_cells);
    round_options.may_gain = may_gain(n_cells);
    Round<Op> round(mesh_, work_, round_options);
    const RoundCounts counts = run_round(round, make_op(), list);
    total += counts;
    if (counts.held_back > 0) control_.note_cell_bound(options_.max_cells);
    if (n_invalid_ > 0) count(focus);
    if (r == 0) first = counts.winners;
    if (kind == kInsert && counts.winners < counts.held_back) break;  // the room is used up
    if (!replay_ && counts.winners * kLittle <= first && !(kind == kInsert && !waiting_.empty())) break;
  }
  count(focus);
  report(kNames[kind], iteration, total, control_.seconds() - start);
  return total.winners;
}

template <class Metric>
std::size_t Stage<Metric>::edge_pass(int iteration, Focus focus) {
  if (on_device(kEdge))
    if (const auto changes = device_rounds(kEdge, iteration, focus)) return *changes;
  return rounds(
      kEdge, iteration, focus,
      [&] {
        return EdgeRemoval<Metric>{metric_, work_.quality};
      },
      [&](auto& round, const auto& op, const Worklist& list) {
        return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
          visit_edge_seeds(mesh_, list, CellHandle(list.cells()[i]), visit);
        });
      });
}

template <class Metric>
std::size_t Stage<Metric>::face_pass(int iteration, Focus focus) {
  if (on_device(kFace))
    if (const auto changes = device_rounds(kFace, iteration, focus)) return *changes;
  return rounds(
      kFace, iteration, focus,
      [&] {
        return FaceSwap<Metric>{metric_, work_.quality};
      },
      [&](auto& round, const auto& op, const Worklist& list) {
        return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
          visit_face_seeds(mesh_, list, CellHandle(list.cells()[i]), visit);
        });
      });
}

template <class Metric>
std::vector<VertexHandle> Stage<Metric>::removable(const Worklist& list) const {
  std::vector<VertexHandle> vertices = vertex_seeds(mesh_, list, work_.frozen, options_.policy);
  drop_pinched(mesh_, work_.star_size, vertices, options_.policy);
  return vertices;
}

template <class Metric>
std::size_t Stage<Metric>::node_pass(int iteration, Focus focus) {
  if (on_device(kNode))
    if (const auto changes = device_rounds(kNode, iteration, focus)) return *changes;
  return rounds(
      kNode, iteration, focus,
      [&] {
        return VertexRemoval<Metric>{metric_, work_.quality, work_.frozen};
      },
      [&](auto& round, const auto& op, const Worklist& list) { return round.run(op, removable(list)); });
}

template <class Metric>
std::size_t Stage<Metric>::mixed_pass(int iteration, Focus focus, bool with_node) {
  // Towards an angle several faces at once; see multi_face_pass().
  using Faces = std::conditional_t<kMeasuresAngles<Metric>, MultiFaceRemoval<Metric>, FaceSwap<Metric>>;
  using Op = AnyOf<EdgeRemoval<Metric>, Faces, VertexRemoval<Metric>>;
  using Seed = typename Op::Seed;
  const bool with_edge = has(options_.ops, Ops::kEdge);
  const bool with_face = has(options_.ops, Ops::kFace);
  return rounds(
      kMixed, iteration, focus,
      [&] {
        return Op{{EdgeRemoval<Metric>{metric_, work_.quality}, Faces{metric_, work_.quality},
                   VertexRemoval<Metric>{metric_, work_.quality, work_.frozen}}};
      },
      [&](auto& round, const auto& op, const Worklist& list) {
        const std::size_t n_cells = list.cells().size();
        std::vector<VertexHandle> vertices;
        if (with_node && has(options_.ops, Ops::kNode)) vertices = removable(list);
        return round.run(op, n_cells + vertices.size(), [&](std::size_t i, auto&& visit) {
          if (i >= n_cells) return visit(Seed(std::in_place_index<2>, vertices[i - n_cells]));
          const CellHandle c(list.cells()[i]);
          if (with_edge)
            visit_edge_seeds(mesh_, list, c, [&](EdgeHandle e) { visit(Seed(std::in_place_index<0>, e)); });
          if (with_face)
            visit_face_seeds(mesh_, list, c,
                             [&](HalfFaceHandle h) { visit(Seed(std::in_place_index<1>, h)); });
        });
      });
}

template <class Metric>
std::size_t Stage<Metric>::multi_face_pass(int iteration, Focus focus) {
  using Op = MultiFaceRemoval<Metric>;
  return rounds(
      kMultiFace, iteration, focus,
      [&] {
        return Op{metric_, work_.quality};
      },
      [&](auto& round, const auto& op, const Worklist& list) {
        return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
          visit_face_seeds(mesh_, list, CellHandle(list.cells()[i]),
                           [&](HalfFaceHandle h) { visit(typename Op::Seed(h)); });
        });
      });
}

template <class Metric>
std::size_t Stage<Metric>::fan_pass(int iteration, Focus focus) {
  if constexpr (!kMeasuresAngles<Metric>) {
    return 0;  // only the polish asks for it
  } else {
    using Op = FanMerge<Metric>;
    return rounds(
        kFan, iteration, focus,
        [&] {
          return Op{metric_, work_.quality};
        },
        [&](auto& round, const auto& op, const Worklist& list) {
          return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
            for (std::uint8_t e = 0; e < 6; ++e)
              visit(typename Op::Seed{CellHandle(list.cells()[i]), e, 0, 0});
          });
        });
  }
}

template <class Metric>
auto Stage<Metric>::worst_apart(const Worklist& list, Focus focus) -> std::vector<CellHandle> {
  std::vector<Index> order;
  std::set_union(list.cells().begin(), list.cells().end(), waiting_.begin(), waiting_.end(),
                 std::back_inserter(order));
  std::erase_if(order, [&](Index c) { return !(work_.quality[c] < focus.below); });
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return work_.quality[a] < work_.quality[b]; });
  waiting_.clear();
  std::vector<std::uint8_t> taken(mesh_.n_vertices(), 0);
  std::vector<CellHandle> chosen;
  for (Index c : order) {
    const auto& v = mesh_.cell(CellHandle(c)).v;
    if (std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return taken[u.idx()] != 0; })) {
      waiting_.push_back(c);
      continue;
    }
    for (VertexHandle u : v) taken[u.idx()] = 1;
    chosen.push_back(CellHandle(c));
  }
  std::sort(waiting_.begin(), waiting_.end());
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

template <class Metric>
bool Stage<Metric>::has_room() const {
  return options_.max_cells == 0 || mesh_.n_logical_cells() + kLeastRoom <= options_.max_cells;
}

template <class Metric>
std::size_t Stage<Metric>::insert_pass(int iteration, Focus focus, double gain) {
  using Op = VertexInsertion<Metric>;
  if (gain != insert_gain_) {  // what has been refused may now do
    insert_gain_ = gain;
    looked_[kInsert] = 0;
    waiting_.clear();
  }
  if (!has_room()) {
    control_.note_cell_bound(options_.max_cells);
    return 0;
  }
  const std::size_t n_inside = rounds(
      kInsert, iteration, focus,
      [&] {
        return Op{metric_, work_.quality, gain};
      },
      [&](auto& round, Op op, const Worklist& list) {
        if (!focus.everything() && !control_.spares_nothing()) op.poor_below = focus.below;
        std::vector<typename Op::Seed> seeds;
        for (CellHandle c : worst_apart(list, focus)) seeds.emplace_back(c);
        if (seeds.size() + waiting_.size() > kFewSeeds) {
          op.max_sites = kSitesOfMany;
          if (!control_.surface()) op.least_promise = kPromiseOfMany;
        }
        return round.run(op, seeds);
      });
  return n_inside + (control_.surface() ? surface_splits(iteration, focus) : 0);
}

template <class Metric>
std::size_t Stage<Metric>::cluster_pass(int iteration, Focus focus) {
  using Op = ClusterSearch<Metric>;
  return rounds(
      kCluster, iteration, focus,
      [&] {
        return Op{metric_, work_.quality, kLeastGain, kSearchPoints, kSearchNodes};
      },
      [&](auto& round, const auto& op, const Worklist& list) {
        return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
          visit(typename Op::Seed(CellHandle(list.cells()[i])));
        });
      });
}

template <class Metric>
template <Cluster kStar>
std::size_t Stage<Metric>::star_pass(int iteration) {
  constexpr Kind kKind = kStar == Cluster::kEdge ? kEdge : kStar == Cluster::kFace ? kFace : kNode;
  using Op = StarFromVertex<kStar, Metric>;
  using Seed = typename Op::Seed;
  return rounds(
      kKind, iteration, Focus{},
      [&] {
        return Op{metric_, work_.quality, work_.frozen, has(options_.ops, Ops::kInsert)};
      },
      [&](auto& round, const auto& op, const Worklist& list) {
        if constexpr (kStar == Cluster::kNode) {
          std::vector<Seed> seeds;
          for (VertexHandle v : removable(list))
            seeds.push_back({mesh_.hook(v), static_cast<std::uint8_t>(mesh_.cell(mesh_.hook(v)).corner(v))});
          return round.run(op, seeds);
        } else {
          return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
            const CellHandle c(list.cells()[i]);
            if constexpr (kStar == Cluster::kEdge)
              visit_edge_seeds(mesh_, list, c, [&](EdgeHandle e) {
                visit(Seed{c, static_cast<std::uint8_t>(e.idx() % 6)});
              });
            else
              visit_face_seeds(mesh_, list, c, [&](HalfFaceHandle h) {
                visit(Seed{c, static_cast<std::uint8_t>(corner_of(h))});
              });
          });
        }
      });
}

template <class Metric>
std::size_t Stage<Metric>::smooth_pass(int iteration, Focus focus) {
  if (!replay_ && control_.stopped()) return 0;
  if (on_device(kSmooth)) {
    if (const auto changes = device_smooth(iteration, focus)) return *changes;
    if (control_.stopped()) return 0;
  }
  const double start = control_.seconds();
  const Worklist list = worklist(kSmooth, focus);
  const auto vertices = vertex_seeds(mesh_, list, work_.frozen, options_.policy);
  RoundCounts counts;
  const auto run = [&](const auto& search) {
    counts += hfr::smooth_pass(mesh_, work_, search, metric_, vertices, options_.policy);
  };
  if (!vertices.empty()) {
    switch (options_.compat == Compat::kJpdc2013 ? Smoother::kCandidates : options_.smoother) {
      case Smoother::kNewton:
        // Towards an angle, the angles themselves; volume-length only stands in for them.
        if constexpr (kMeasuresAngles<Metric>)
          run(MaxMinSearch{});
        else
          run(NewtonSearch{});
        break;
      case Smoother::kCandidates:
        run(CandidateSearch{});
        break;
      case Smoother::kLaplacian:
        run(LaplacianSearch{});
        break;
      case Smoother::kTaubin:
        run(kTaubinForth);
        run(kTaubinBack);
        break;
    }
  }
  count(focus);
  report(kNames[kSmooth], iteration, counts, control_.seconds() - start);
  return counts.winners;
}

template <class Metric>
bool Stage<Metric>::is_mixed() const {
  const int n_kinds =
      has(options_.ops, Ops::kEdge) + has(options_.ops, Ops::kFace) + has(options_.ops, Ops::kNode);
  if (n_kinds < 2) return false;
  if (options_.rounds != Rounds::kAuto) return options_.rounds == Rounds::kMixed;
  return !options_.min_dihedral && kMeasuresAngles<Metric>;
}

template <class Metric>
std::size_t Stage<Metric>::iterate(int iteration, Focus focus, bool with_node) {
  std::size_t changes = 0;
  if (is_mixed()) {
    changes += mixed_pass(iteration, focus, with_node);
  } else {
    if (has(options_.ops, Ops::kEdge)) changes += edge_pass(iteration, focus);
    if (has(options_.ops, Ops::kFace))
      changes += kMeasuresAngles<Metric> ? multi_face_pass(iteration, focus) : face_pass(iteration, focus);
    if (with_node && has(options_.ops, Ops::kNode)) changes += node_pass(iteration, focus);
  }
  if (control_.surface()) changes += surface_pass(iteration, focus, with_node);
  if (has(options_.ops, Ops::kSmooth)) changes += smooth_pass(iteration, focus);
  return changes;
}

template <class Metric>
void Stage<Metric>::report(const char* op, int iteration, const RoundCounts& counts, double seconds) {
  if (replay_) return;
  PassReport pass;
  pass.stage = name_;
  pass.op = op;
  pass.iteration = iteration;
  pass.rounds = counts.rounds;
  pass.seeds = counts.seeds;
  pass.candidates = counts.candidates;
  pass.winners = counts.winners;
  pass.sub_rounds = counts.sub_rounds;
  pass.n_inverted = n_invalid_;
  pass.worst = worst_;
  pass.seconds = seconds;
  pass.seconds_evaluate = counts.seconds_evaluate;
  pass.seconds_select = counts.seconds_select;
  pass.seconds_commit = counts.seconds_commit;
  pass.on_device = resident_;
  control_.add(std::move(pass));
  if (!options_.progress) return;
  const double smallest =
      resident_ ? report_value(hfr::Metric::kMinDihedral, control_.device()->smallest_dihedral())
                : smallest_dihedral(mesh_, options_.policy);
  options_.progress({name_, iteration, control_.fraction(), n_invalid_, smallest});
}

}  // namespace hfr

#include "Remesh/StageOnDevice.hh"

namespace hfr {

template std::size_t Stage<VolumeLength>::star_pass<Cluster::kEdge>(int);
template std::size_t Stage<VolumeLength>::star_pass<Cluster::kFace>(int);
template std::size_t Stage<VolumeLength>::star_pass<Cluster::kNode>(int);
template class Stage<VolumeLength>;
template class Stage<Untangling>;
template class Stage<MinSine2>;
template class Stage<MinDihedral>;
template class Stage<CustomMetric>;

}  // namespace hfr
