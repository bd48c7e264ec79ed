// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartPasses.hh"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>
#include <utility>

#include "Distributed/LookOptions.hh"
#include "Distributed/PartInsertion.hh"
#include "Distributed/PartRound.hh"
#include "Distributed/PartSearch.hh"
#include "Distributed/PartSeeds.hh"
#include "Distributed/PartSmoothing.hh"
#include "Distributed/Spread.hh"
#include "Operators/AnyOf.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/FanMerge.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/SmoothMaxMin.hh"
#include "Operators/SmoothNewton.hh"
#include "Operators/VertexCollapse.hh"
#include "Remesh/Survey.hh"

namespace hfr::mpi {
bool PartPasses::can_do(PassKind kind, const RankMetric& metric) {
  return (metric.metric == Metric::kMinSine || metric.metric == Metric::kMinDihedral ||
          metric.metric == Metric::kVolumeLength) &&
         (kind == PassKind::kEdge || kind == PassKind::kFace || kind == PassKind::kMultiFace ||
          kind == PassKind::kNode || kind == PassKind::kSmooth || kind == PassKind::kFan ||
          kind == PassKind::kMixed);
}

Ranks::Tally PartPasses::tally(double below) {
  const Comm::InPhase phase(parts_.comm(), Phase::kTally);
  struct Found {
    std::array<std::uint64_t, 2> sums{};  // invalid, below
    double worst = std::numeric_limits<double>::infinity();
  };
  const TetMesh& part = parts_.part();
  const std::vector<double>& quality = parts_.work().quality;
  const auto look = [&](std::size_t i, Found& found) {
    const double q = quality[i];
    // Deleted ones and most others are nowhere near.
    if (q > 0 && !(q < below) && !(q < found.worst)) return;
    const CellHandle c(i);
    if (part.is_deleted(c) || !parts_.is_own(c)) return;
    found.sums[0] += q > 0 ? 0 : 1;
    found.sums[1] += q < below ? 1 : 0;
    found.worst = std::min(found.worst, q);
  };
  Found all;
  if (below > 0) {
    for (Index i : poor_.below(below, parts_.work(), {})) look(i, all);
    all.worst = parts_.comm().sum_and_min(all.sums, all.worst);
  }
  if (all.sums[1] == 0) {  // else the worst and all that are invalid are among those
    all = {};
    for (std::size_t i = 0; i < quality.size(); ++i) look(i, all);
    all.worst = parts_.comm().sum_and_min(all.sums, all.worst);
  }
  return {static_cast<std::size_t>(all.sums[0]), static_cast<std::size_t>(all.sums[1]), all.worst};
}

RoundCounts PartPasses::run(const Ranks::Look& look) {
  const Comm::InPhase phase(parts_.comm(), Phase::kEvaluate);
  return with_metric(look, [&](const auto& metric) { return pass(look, metric); });
}

RoundCounts PartPasses::dig(const Ranks::Dig& dig, std::vector<std::uint64_t>& waiting) {
  const Comm::InPhase phase(parts_.comm(), Phase::kEvaluate);
  const RoundCounts counts = insert_in_parts(parts_, dig, listed(dig.look), waiting);
  n_rounds_ += counts.rounds;
  return counts;
}

RoundCounts PartPasses::search(const Ranks::Search& search) {
  const Comm::InPhase phase(parts_.comm(), Phase::kEvaluate);
  const RoundCounts counts = search_in_parts(parts_, search, listed(search.look));
  n_rounds_ += counts.rounds;
  return counts;
}

Worklist PartPasses::listed(const Ranks::Look& look) {
  const TetMesh& part = parts_.part();
  Workspace& work = parts_.work();
  const par::Policy policy{look.threads};
  return Worklist(part, policy, poor_.below(look.below, work, policy), [&](CellHandle c) {
    const auto& v = part.cell(c).v;
    return std::any_of(v.begin(), v.end(),
                       [&](VertexHandle u) { return work.changed[u.idx()] > look.since; }) &&
           (!look.is_marked || std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return is_marked(u); }));
  });
}

bool PartPasses::is_marked(VertexHandle v) const {
  const std::uint64_t number = parts_.number(v);
  return number >= newer_from_ || std::binary_search(marked_.begin(), marked_.end(), number);
}

void PartPasses::mark_round(std::span<const CellHandle> cells, int layers) {
  Spread spread(parts_, Spread::Stars::kWalked, 0);  // as vertices_within()
  for (CellHandle c : cells) spread.begin(c, static_cast<std::uint32_t>(layers));
  spread.run();
  marked_.clear();
  const std::vector<VertexHandle> own = std::move(spread.take_own().front());
  for (VertexHandle v : own) marked_.push_back(parts_.number(v));
  marked_ = parts_.comm().all_gather(std::span<const std::uint64_t>(marked_));
  std::sort(marked_.begin(), marked_.end());
  newer_from_ = parts_.n_vertices();
}

template <class M>
RoundCounts PartPasses::pass(const Ranks::Look& look, const M& metric) {
  const TetMesh& part = parts_.part();
  Workspace& work = parts_.work();
  const par::Policy policy{look.threads};
  const Worklist list = listed(look);
  std::array<std::uint64_t, 2> listed = {list.cells().size(), 0};
  if (look.kind == PassKind::kEdge) listed[1] = n_own(list.cells());
  parts_.comm().sum(listed);
  if (listed[0] == 0) return {};
  ++n_rounds_;
  switch (look.kind) {
    case PassKind::kEdge:
      return round<EdgeRemoval<M>>(look, {metric, work.quality}, list, listed[1] > look.first_edge_beyond);
    case PassKind::kFace:
      return round<FaceSwap<M>>(look, {metric, work.quality}, list);
    case PassKind::kMultiFace:
      return round<MultiFaceRemoval<M>>(look, {metric, work.quality}, list);
    case PassKind::kFan:
      return round<FanMerge<M>>(look, {metric, work.quality}, list);
    case PassKind::kMixed:
      return mixed(look, metric, list);
    case PassKind::kNode: {
      using Op = VertexCollapse<M>;
      PartRound place(parts_);
      Round<Op> round(parts_.part(), work, options_of(look, place));
      return round.run(Op{metric, work.quality, work.frozen}, removable_seeds(parts_, list, policy));
    }
    default: {
      const auto vertices = vertex_seeds(part, list, work.frozen, policy);
      const auto n_own =
          std::count_if(vertices.begin(), vertices.end(), [&](VertexHandle v) { return parts_.is_own(v); });
      if (parts_.comm().sum(static_cast<std::uint64_t>(n_own)) == 0) return {};
      const Comm::InPhase phase(parts_.comm(), Phase::kSmooth);
      // As smooth_pass() of PassRunner.
      using Search = std::conditional_t<kMeasuresAngles<M>, MaxMinSearch, NewtonSearch>;
      return smooth_parts(parts_, Search{}, metric, vertices, policy);
    }
  }
}

/// As PassRunner has it.
template <class M>
RoundCounts PartPasses::mixed(const Ranks::Look& look, const M& metric, const Worklist& list) {
  using Faces = std::conditional_t<kMeasuresAngles<M>, MultiFaceRemoval<M>, FaceSwap<M>>;
  using Op = AnyOf<EdgeRemoval<M>, Faces, VertexCollapse<M>>;
  using Seed = typename Op::Seed;
  const Workspace& work = parts_.work();
  const Op op{{EdgeRemoval<M>{metric, work.quality}, Faces{metric, work.quality},
               VertexCollapse<M>{metric, work.quality, work.frozen}}};
  const std::size_t n_cells = list.cells().size();
  std::vector<VertexHandle> vertices;
  if (has(look.ops, Ops::kNode)) vertices = removable_seeds(parts_, list, par::Policy{look.threads});
  PartRound place(parts_);
  Round<Op> round(parts_.part(), parts_.work(), options_of(look, place));
  return round.run(op, n_cells + vertices.size(), [&](std::size_t i, auto&& visit) {
    if (i >= n_cells) {
      visit(Seed(std::in_place_index<2>, vertices[i - n_cells]));
      return;
    }
    const CellHandle c(list.cells()[i]);
    if (has(look.ops, Ops::kEdge))
      visit_edge_seeds(parts_, list, c, [&](EdgeHandle e) { visit(Seed(std::in_place_index<0>, e)); });
    if (has(look.ops, Ops::kFace))
      visit_face_seeds(parts_, list, c, [&](HalfFaceHandle h) { visit(Seed(std::in_place_index<1>, h)); });
  });
}

template <class Op>
RoundCounts PartPasses::round(const Ranks::Look& look, const Op& op, const Worklist& list, bool first_does) {
  PartRound place(parts_);
  Round<Op> round(parts_.part(), parts_.work(), options_of(look, place));
  return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
    const CellHandle c(list.cells()[i]);
    if constexpr (IsCellAndEdge<typename Op::Seed>) {
      if (parts_.is_own(c))
        for (std::uint8_t e = 0; e < 6; ++e) visit(typename Op::Seed{c, e, 0, 0});
    } else if constexpr (!std::is_same_v<typename Op::Seed, EdgeHandle>)
      visit_face_seeds(parts_, list, c, [&](HalfFaceHandle h) { visit(typename Op::Seed(h)); });
    else if (first_does)
      visit_edge_seeds_until(parts_, list, c, [&](EdgeHandle e) { return visit(e) >= look.below; });
    else
      visit_edge_seeds(parts_, list, c, visit);
  });
}

/// Of these cells of the part, how many are own ones.
std::uint64_t PartPasses::n_own(std::span<const Index> cells) const {
  return static_cast<std::uint64_t>(
      std::count_if(cells.begin(), cells.end(), [&](Index c) { return parts_.is_own(CellHandle(c)); }));
}

}  // namespace hfr::mpi
