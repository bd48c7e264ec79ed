// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/PassRunner.hh"

#include <algorithm>
#include <array>
#include <iterator>
#include <type_traits>
#include <utility>

#include "Operators/AnyOf.hh"
#include "Operators/ClusterSearch.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/FanMerge.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/SmoothCandidates.hh"
#include "Operators/SmoothLaplacian.hh"
#include "Operators/SmoothMaxMin.hh"
#include "Operators/SmoothNewton.hh"
#include "Operators/StarFromVertex.hh"
#include "Operators/VertexCollapse.hh"
#include "Operators/VertexInsertion.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/SmoothPass.hh"

namespace hfr {
namespace {

// Seeds of a listed cell, about: others have a smaller listed cell, or are constrained.
constexpr double kEdgesOfCell = 4, kFacesOfCell = 3;

}  // namespace

// What there is in improve(), but for the surface: a new operator is its files, one row here, and one line of
// help in the tool.
template <class Metric>
auto PassRunner<Metric>::row(PassKind kind) -> const Row& {
  using Self = PassRunner;
  constexpr Ops kReconnect = Ops::kEdge | Ops::kFace | Ops::kNode;
  static constexpr std::array<Row, static_cast<std::size_t>(PassKind::kCount)> kTable = {{
      {"edge", Ops::kEdge, 0x01, &Self::edge_pass},           // kEdge
      {"face", Ops::kFace, 0x02, &Self::face_pass},           // kFace
      {"node", Ops::kNode, 0x04, &Self::node_pass},           // kNode
      {"insert", Ops::kInsert, 0x08, &Self::insert_pass},     // kInsert
      {"smooth", Ops::kSmooth, 0x10, &Self::smooth_pass},     // kSmooth
      {"face", Ops::kFace, 0x20, &Self::multi_face_pass},     // kMultiFace
      {"mixed", kReconnect, 0x40, &Self::mixed_pass},         // kMixed
      {"cluster", Ops::kCluster, 0x80, &Self::cluster_pass},  // kCluster
      {"edge", Ops::kEdge, 0, &Self::fan_pass},               // kFan
  }};
  return kTable[static_cast<std::size_t>(kind)];
}

template <class Metric>
Run PassRunner<Metric>::with_qualities(const Run& run, const Metric& metric) {
  Workspace& work = run.work;
#ifdef HFR_PARANOID
  if (work.template has_qualities_of<Metric>() && !run.is_part())
    detail::Paranoid(run.mesh, work, "stage", typeid(Metric), metric);
#endif
  if (!work.template has_qualities_of<Metric>()) work.set_qualities(run.mesh, metric, run.policy());
  return run;
}

template <class Metric>
PassRunner<Metric>::PassRunner(const Run& run, Metric metric, std::string stage,
                               std::optional<Selection> selection)
    : PassState(with_qualities(run, metric), std::move(stage)),
      metric_(metric),
      selection_(selection.value_or(run.strategy.pass.selection)),
      surface_(*this, metric) {
  if constexpr (std::is_same_v<Metric, VolumeLength>)
    device_.emplace(*this, [this](PassKind kind, const Turn& turn) { (this->*row(kind).run)(turn); });
  if constexpr (std::is_same_v<Metric, MinSine2>) ranks_.emplace(*this, hfr::Metric::kMinSine);
  if constexpr (std::is_same_v<Metric, MinDihedral>) ranks_.emplace(*this, hfr::Metric::kMinDihedral);
  if constexpr (std::is_same_v<Metric, Untangling> || std::is_same_v<Metric, VolumeLength>)
    if (run.is_part()) ranks_.emplace(*this, rank_metric(metric));
  if (run.checkpoint && may_lower_angles()) run.keep(n_invalid() == 0);
}

template <class Metric>
bool PassRunner<Metric>::may_lower_angles() const {
  if (n_invalid() > 0) return true;
  if constexpr (std::is_same_v<Metric, MinDihedral>) return false;
  // The smallest sine, which may be that of an obtuse angle, is never above the smallest dihedral's.
  if constexpr (std::is_same_v<Metric, MinSine2>) return worst() < run().checkpoint->input().worst;
  return true;
}

template <class Metric>
void PassRunner<Metric>::look_again() {
  PassState::look_again();
  waiting_.clear();
  if (ranks_) ranks_->forget_waiting();
  surface_.look_again();
}

template <class Metric>
bool PassRunner<Metric>::is_mixed() const {
  return selection_ == Selection::kMixed ||
         (selection_ == Selection::kMixedOnAngles && kMeasuresAngles<Metric>);
}

template <class Metric>
std::size_t PassRunner<Metric>::iterate(const Turn& turn) {
  std::size_t changes = 0;
  if (is_mixed()) {
    changes += pass(PassKind::kMixed, turn);
  } else {
    changes += pass(PassKind::kEdge, turn);
    changes += pass(kMeasuresAngles<Metric> ? PassKind::kMultiFace : PassKind::kFace, turn);
    if (turn.removes_vertices) changes += pass(PassKind::kNode, turn);
  }
  if (run().surface) changes += surface_.iterate(turn);
  changes += pass(PassKind::kSmooth, turn);
  return changes;
}

template <class Metric>
std::size_t PassRunner<Metric>::pass(PassKind kind, const Turn& turn) {
  if (kind == PassKind::kInsert) return insert(turn, effort().least_gain);
  const Row& row = PassRunner::row(kind);
  if (!has(effort().ops, row.ops)) return 0;
  if (device_)
    if (const auto changes = device_->run(kind, row.name, row.pending_bit, turn)) return *changes;
  if (ranks_)
    if (const auto changes = ranks_->run(kind, row.name, turn)) return *changes;
  return (this->*row.run)(turn);
}

template <class Metric>
std::size_t PassRunner<Metric>::insert(const Turn& turn, double gain) {
  if (!has(effort().ops, Ops::kInsert)) return 0;
  this->to_host();
  if (gain != insert_gain_) {  // what has been refused may now do
    insert_gain_ = gain;
    look_again_for(PassKind::kInsert);
    waiting_.clear();
    if (ranks_) ranks_->forget_waiting();
  }
  if (!ranks_ || !run().is_part()) return insert_pass(turn);
  const bool has_room = run().has_room();
  const std::size_t n_inserted = ranks_->insert(row(PassKind::kInsert).name, turn, gain);
  return n_inserted + (has_room && run().surface ? surface_.split(turn) : 0);
}

template <class Metric>
template <class Op, class RunRound>
RoundCounts PassRunner<Metric>::round(const RunRound& run_round, const Worklist& list) {
  const Run& run = this->run();
  const std::size_t n_cells = run.mesh.n_logical_cells();
  RoundOptions options{run.policy(), this->checks_links(), effort().seed, effort().ranks_exactly};
  options.may_lose = run.bounds.may_lose(n_cells);
  options.may_gain = run.bounds.may_gain(n_cells);
  Round<Op> round(run.mesh, run.work, options);
  const RoundCounts counts = run_round(round, list);
  if (counts.held_back > 0) run.findings.note_cell_bound(run.bounds);
  return counts;
}

template <class Metric>
template <class Op, class RunRound>
std::size_t PassRunner<Metric>::rounds(PassKind kind, const Turn& turn, const RunRound& run_round) {
  RunControl& control = run().control;
  const Row& row = PassRunner::row(kind);
  const double start = control.seconds();
  const std::size_t most = turn.replayed_rounds.value_or(static_cast<std::size_t>(effort().rounds));
  RoundCounts total;
  std::size_t first = 0;
  for (std::size_t r = 0; r < most && (turn.replayed_rounds || !control.stopped()); ++r) {
    const Worklist list = worklist(kind, row.pending_bit, turn.focus);
    if (list.cells().empty()) break;
    const RoundCounts counts = round<Op>(run_round, list);
    total += counts;
    if (n_invalid() > 0) count(turn.focus);
    if (r == 0) first = counts.winners;
    if (!turn.replayed_rounds && counts.winners * effort().little <= first) break;
  }
  count(turn.focus);
  report(row.name, turn, total, control.seconds() - start);
  return total.winners;
}

template <class Metric>
std::size_t PassRunner<Metric>::edge_pass(const Turn& turn) {
  using Op = EdgeRemoval<Metric>;
  const Run& run = this->run();
  return rounds<Op>(PassKind::kEdge, turn, [&](auto& round, const Worklist& list) {
    const std::size_t n_cells = list.cells().size();
    // On a device all edges are looked at, and so they are here in the metric of its passes.
    const bool first_does =
        kMeasuresAngles<Metric> && effort().first_edge_does && n_cells > effort().few_seeds;
    return round.run(
        Op{metric_, run.work.quality}, n_cells,
        [&](std::size_t i, auto&& visit) {
          const CellHandle c(list.cells()[i]);
          if (first_does)
            visit_edge_seeds_until(run.mesh, list, c,
                                   [&](EdgeHandle e) { return visit(e) >= turn.focus.below; });
          else
            visit_edge_seeds(run.mesh, list, c, visit);
        },
        kEdgesOfCell);
  });
}

template <class Metric>
std::size_t PassRunner<Metric>::face_pass(const Turn& turn) {
  using Op = FaceSwap<Metric>;
  const Run& run = this->run();
  return rounds<Op>(PassKind::kFace, turn, [&](auto& round, const Worklist& list) {
    return round.run(
        Op{metric_, run.work.quality}, list.cells().size(),
        [&](std::size_t i, auto&& visit) {
          visit_face_seeds(run.mesh, list, CellHandle(list.cells()[i]), visit);
        },
        kFacesOfCell);
  });
}

template <class Metric>
std::vector<VertexHandle> PassRunner<Metric>::removable(const Worklist& list) const {
  const Run& run = this->run();
  std::vector<VertexHandle> vertices = vertex_seeds(run.mesh, list, run.work.frozen, run.policy());
  drop_pinched(run.mesh, run.work, vertices);
  return vertices;
}

template <class Metric>
std::size_t PassRunner<Metric>::node_pass(const Turn& turn) {
  using Op = VertexCollapse<Metric>;
  const Workspace& work = run().work;
  return rounds<Op>(PassKind::kNode, turn, [&](auto& round, const Worklist& list) {
    return round.run(Op{metric_, work.quality, work.frozen}, removable(list));
  });
}

template <class Metric>
std::size_t PassRunner<Metric>::mixed_pass(const Turn& turn) {
  // Towards an angle several faces at once; see multi_face_pass().
  using Faces = std::conditional_t<kMeasuresAngles<Metric>, MultiFaceRemoval<Metric>, FaceSwap<Metric>>;
  using Op = AnyOf<EdgeRemoval<Metric>, Faces, VertexCollapse<Metric>>;
  using Seed = typename Op::Seed;
  const Run& run = this->run();
  const Workspace& work = run.work;
  const bool with_edge = has(effort().ops, Ops::kEdge);
  const bool with_face = has(effort().ops, Ops::kFace);
  return rounds<Op>(PassKind::kMixed, turn, [&](auto& round, const Worklist& list) {
    const Op op{{EdgeRemoval<Metric>{metric_, work.quality}, Faces{metric_, work.quality},
                 VertexCollapse<Metric>{metric_, work.quality, work.frozen}}};
    const std::size_t n_cells = list.cells().size();
    std::vector<VertexHandle> vertices;
    if (turn.removes_vertices && has(effort().ops, Ops::kNode)) vertices = removable(list);
    return round.run(
        op, n_cells + vertices.size(),
        [&](std::size_t i, auto&& visit) {
          if (i >= n_cells) {
            visit(Seed(std::in_place_index<2>, vertices[i - n_cells]));
            return;
          }
          const CellHandle c(list.cells()[i]);
          if (with_edge)
            visit_edge_seeds(run.mesh, list, c,
                             [&](EdgeHandle e) { visit(Seed(std::in_place_index<0>, e)); });
          if (with_face)
            visit_face_seeds(run.mesh, list, c,
                             [&](HalfFaceHandle h) { visit(Seed(std::in_place_index<1>, h)); });
        },
        kEdgesOfCell + kFacesOfCell);
  });
}

template <class Metric>
std::size_t PassRunner<Metric>::multi_face_pass(const Turn& turn) {
  using Op = MultiFaceRemoval<Metric>;
  const Run& run = this->run();
  return rounds<Op>(PassKind::kMultiFace, turn, [&](auto& round, const Worklist& list) {
    return round.run(
        Op{metric_, run.work.quality}, list.cells().size(),
        [&](std::size_t i, auto&& visit) {
          visit_face_seeds(run.mesh, list, CellHandle(list.cells()[i]),
                           [&](HalfFaceHandle h) { visit(typename Op::Seed(h)); });
        },
        kFacesOfCell);
  });
}

template <class Metric>
std::size_t PassRunner<Metric>::fan_pass(const Turn& turn) {
  if constexpr (!kMeasuresAngles<Metric>) {
    static_cast<void>(turn);
    return 0;  // only the polish asks for it
  } else {
    using Op = FanMerge<Metric>;
    return rounds<Op>(PassKind::kFan, turn, [&](auto& round, const Worklist& list) {
      return round.run(Op{metric_, run().work.quality}, list.cells().size(),
                       [&](std::size_t i, auto&& visit) {
                         for (std::uint8_t e = 0; e < 6; ++e)
                           visit(typename Op::Seed{CellHandle(list.cells()[i]), e, 0, 0});
                       });
    });
  }
}

template <class Metric>
auto PassRunner<Metric>::worst_apart(const Worklist& list, const Focus& focus) -> std::vector<CellHandle> {
  const auto& quality = run().work.quality;
  const auto is_worse = [&](Index a, Index b) {
    return quality[a] != quality[b] ? quality[a] < quality[b] : a < b;
  };
  // Whatever a round or a pass has changed is listed, so what waits and is not listed is in order still,
  // unless another mesh was put back meanwhile.
  std::erase_if(waiting_, [&](Index c) {
    return c >= quality.size() || list.has(CellHandle(c)) || !(quality[c] < focus.below);
  });
  if (!std::is_sorted(waiting_.begin(), waiting_.end(), is_worse))
    std::sort(waiting_.begin(), waiting_.end(), is_worse);
  std::vector<Index> listed;
  std::copy_if(list.cells().begin(), list.cells().end(), std::back_inserter(listed),
               [&](Index c) { return quality[c] < focus.below; });
  std::sort(listed.begin(), listed.end(), is_worse);
  std::vector<Index> order;
  order.reserve(waiting_.size() + listed.size());
  std::merge(waiting_.begin(), waiting_.end(), listed.begin(), listed.end(), std::back_inserter(order),
             is_worse);
  waiting_.clear();
  taken_.resize(run().mesh.n_vertices(), 0);
  ++choice_;
  std::vector<CellHandle> chosen;
  for (Index c : order) {
    const auto& v = run().mesh.cell(CellHandle(c)).v;
    if (std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return taken_[u.idx()] == choice_; })) {
      waiting_.push_back(c);
      continue;
    }
    for (VertexHandle u : v) taken_[u.idx()] = choice_;
    chosen.push_back(CellHandle(c));
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// Rounds of its own: seeds that are near one another wait for the next round, and the room for new cells may
/// be used up.
template <class Metric>
std::size_t PassRunner<Metric>::insert_pass(const Turn& turn) {
  using Op = VertexInsertion<Metric>;
  const Run& run = this->run();
  const PassEffort& effort = this->effort();
  const Row& row = PassRunner::row(PassKind::kInsert);
  if (!run.has_room()) {
    run.findings.note_cell_bound(run.bounds);
    return 0;
  }
  const double start = run.control.seconds();
  RoundCounts total;
  std::size_t first = 0;
  for (int r = 0; r < effort.insert_rounds && !run.control.stopped(); ++r) {
    const Worklist list = worklist(PassKind::kInsert, row.pending_bit, turn.focus);
    if (list.cells().empty() && waiting_.empty()) break;
    const RoundCounts counts = round<Op>(
        [&](auto& round, const Worklist& cells) {
          Op op{metric_, run.work.quality, insert_gain_};
          op.leaves_early = effort.leaves_early;
          if (!turn.focus.everything() && !run.may_add_poor_cells) op.poor_below = turn.focus.below;
          std::vector<typename Op::Seed> seeds;
          for (CellHandle c : worst_apart(cells, turn.focus)) seeds.emplace_back(c);
          if (seeds.size() + waiting_.size() > effort.few_seeds) {
            op.max_sites = effort.sites_of_many;
            op.least_promise = effort.promise_of_many;
          }
          return round.run(op, seeds);
        },
        list);
    total += counts;
    if (n_invalid() > 0) count(turn.focus);
    if (r == 0) first = counts.winners;
    if (counts.winners < counts.held_back) break;  // the room is used up
    if (turn.is_vain(counts, effort.few_seeds, r == 0)) break;
    if (counts.winners * effort.little <= first && waiting_.empty()) break;
  }
  count(turn.focus);
  report(row.name, turn, total, run.control.seconds() - start);
  return total.winners + (run.surface ? surface_.split(turn) : 0);
}

template <class Metric>
std::size_t PassRunner<Metric>::cluster_pass(const Turn& turn) {
  using Op = ClusterSearch<Metric>;
  const PassEffort& effort = this->effort();
  return rounds<Op>(PassKind::kCluster, turn, [&](auto& round, const Worklist& list) {
    const Op op{metric_, run().work.quality, effort.least_gain, effort.search_points, effort.search_nodes};
    return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
      visit(typename Op::Seed(CellHandle(list.cells()[i])));
    });
  });
}

template <class Metric>
std::size_t PassRunner<Metric>::star_pass(PassKind kind, int iteration) {
  static_cast<void>(kind), static_cast<void>(iteration);
  if constexpr (std::is_same_v<Metric, VolumeLength>) {
    if (!has(effort().ops, row(kind).ops)) return 0;
    const TetMesh& mesh = run().mesh;
    const Workspace& work = run().work;
    const auto pass = [&]<Cluster kStar>(std::integral_constant<Cluster, kStar>) {
      using Op = StarFromVertex<kStar, Metric>;
      using Seed = typename Op::Seed;
      return rounds<Op>(kind, {.iteration = iteration}, [&](auto& round, const Worklist& list) {
        const Op op{metric_, work.quality, work.frozen, has(effort().ops, Ops::kInsert)};
        if constexpr (kStar == Cluster::kNode) {
          std::vector<Seed> seeds;
          for (VertexHandle v : removable(list))
            seeds.push_back({mesh.incident_cell(v),
                             static_cast<std::uint8_t>(mesh.cell(mesh.incident_cell(v)).corner(v))});
          return round.run(op, seeds);
        } else {
          return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
            const CellHandle c(list.cells()[i]);
            if constexpr (kStar == Cluster::kEdge)
              visit_edge_seeds(mesh, list, c, [&](EdgeHandle e) {
                visit(Seed{c, static_cast<std::uint8_t>(e.idx() % 6)});
              });
            else
              visit_face_seeds(mesh, list, c, [&](HalfFaceHandle h) {
                visit(Seed{c, static_cast<std::uint8_t>(corner_of(h))});
              });
          });
        }
      });
    };
    if (kind == PassKind::kEdge) return pass(std::integral_constant<Cluster, Cluster::kEdge>{});
    if (kind == PassKind::kFace) return pass(std::integral_constant<Cluster, Cluster::kFace>{});
    if (kind == PassKind::kNode) return pass(std::integral_constant<Cluster, Cluster::kNode>{});
  }
  return 0;
}

template <class Metric>
std::size_t PassRunner<Metric>::smooth_pass(const Turn& turn) {
  const Run& run = this->run();
  if (!turn.replayed_rounds && run.control.stopped()) return 0;
  const Row& row = PassRunner::row(PassKind::kSmooth);
  const double start = run.control.seconds();
  const Worklist list = worklist(PassKind::kSmooth, row.pending_bit, turn.focus);
  const auto vertices = vertex_seeds(run.mesh, list, run.work.frozen, run.policy());
  RoundCounts counts;
  const auto smooth = [&](const auto& search) {
    counts += hfr::smooth_pass(run.mesh, run.work, search, metric_, vertices, run.policy());
  };
  if (!vertices.empty()) {
    switch (effort().smoother) {
      case Smoother::kNewton:
        // Towards an angle, the angles themselves; volume-length only stands in for them.
        if constexpr (kMeasuresAngles<Metric>)
          smooth(MaxMinSearch{});
        else
          smooth(NewtonSearch{});
        break;
      case Smoother::kCandidates:
        smooth(CandidateSearch{});
        break;
      case Smoother::kLaplacian:
        smooth(LaplacianSearch{});
        break;
      case Smoother::kTaubin:
        smooth(kTaubinForth);
        smooth(kTaubinBack);
        break;
    }
  }
  count(turn.focus);
  report(row.name, turn, counts, run.control.seconds() - start);
  return counts.winners;
}

template class PassRunner<VolumeLength>;
template class PassRunner<Untangling>;
template class PassRunner<MinSine2>;
template class PassRunner<MinDihedral>;
template class PassRunner<CustomMetric>;

}  // namespace hfr
