// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_ROUND_HH
#define HFR_SCHEDULER_ROUND_HH

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Operators/Operator.hh"
#include "hfremesh/Parallel/Parallel.hh"
#include "hfremesh/Scheduler/ChunkedArray.hh"
#include "hfremesh/Scheduler/SeedAddress.hh"
#include "hfremesh/Scheduler/Workspace.hh"

namespace hfr {

class RoundPlace;

struct RoundOptions {
  par::Policy policy;
  /// Hold the full link condition, also among the winners of the round. Needed while any cell is inverted or
  /// flat, and where cells lie over one another; elsewhere a cluster whose cells stay positive cannot break
  /// it. Where it has two vertices that are pinched (Workspace::pinched), what would come twice is refused in
  /// any case.
  bool check_links = true;
  std::uint64_t seed = 1;
  /// Rank by the exact worst cell, as the paper's ASSIGNMENT does, instead of by buckets of it. Neighbours
  /// are then often neighbours in rank: costs the claims many sub-rounds, and is no better
  /// (docs/scheduler.md).
  bool worst_first = false;
  /// Cells that removals of vertices may take away in one round, and insertions add. What would exceed that
  /// is given up, the last in rank order first.
  std::size_t may_lose = std::numeric_limits<std::size_t>::max();
  std::size_t may_gain = std::numeric_limits<std::size_t>::max();
  /// Where the mesh is a part of a larger one; null: it is all there is. There is no worst_first then; where
  /// operators add vertices, they come last in the order of numbers (docs/distributed.md).
  RoundPlace* place = nullptr;
};

namespace detail {

/// A round whatever its operator: compiled once, in Round.cc, and told of the operator's candidates by
/// Round. They are asked for from several threads at once.
class RoundCore {
 protected:
  RoundCore(TetMesh& mesh, Workspace& work, RoundOptions options, bool ranks_by_gain);
  virtual ~RoundCore();
  RoundCore(const RoundCore&) = delete;
  RoundCore& operator=(const RoundCore&) = delete;

  virtual std::size_t n_candidates() const = 0;
  virtual const PlanBase& candidate(std::size_t i) const = 0;
  virtual void scope(const PlanBase& plan, Scope& out) const = 0;
  virtual void cavity(const PlanBase& plan, Cavity& out) const = 0;
  virtual Tet identity(const PlanBase& plan) const = 0;
  virtual double quality(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const = 0;
  /// Brings the workspace's qualities of these cells up to date.
  virtual void measure(std::span<const CellHandle> cells) const = 0;
  /// Fills the candidates in the order of the seeds; returns how many seeds there were.
  virtual std::size_t evaluate() = 0;
  /// Of the seed of a candidate.
  virtual SeedAddress address(const PlanBase& plan) const = 0;
  /// Evaluates the seed there, which improves its cluster, into one more candidate; returns its number.
  virtual std::size_t add_candidate(const SeedAddress& at) = 0;

  RoundCounts run();
  /// Whether candidates have to pass may_be_committed(); before the first is asked about.
  bool needs_admission();
  bool may_be_committed(const PlanBase& plan, bool check, Cavity& cavity, Star& scratch) const;
  std::size_t n_winners() const;
  std::size_t candidate_of(std::size_t winner) const;
  VertexHandle new_vertex_of(std::size_t winner) const;

  TetMesh& mesh_;
  Workspace& work_;
  RoundOptions options_;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace detail

/// One round of one operator kind, or of several that compete (see AnyOf): evaluate the seeds in parallel,
/// rank what improves, select the first independent set in rank order, hand out slots, commit in bulk,
/// refresh. The result depends on mesh, seeds (as a set) and options, not on the number of threads. What lost
/// is not remembered: it shared a cell with a winner, so its evaluation is void; the winner's new cells are
/// pending instead.
template <LocalOperator Op>
class Round : private detail::RoundCore {
 public:
  Round(TetMesh& mesh, Workspace& work, RoundOptions options)
      : RoundCore(
            mesh, work, options, requires { Op::kRankByGain; }) {}

  /// Looks at every seed of the list.
  RoundCounts run(const Op& op, std::span<const typename Op::Seed> seeds) {
    return run(op, seeds.size(), [&](std::size_t i, auto&& visit) { visit(seeds[i]); });
  }

  /// Looks at what visit_seeds(i, visit) passes to visit(seed), for i = 0 … n_sources-1: seeds are made where
  /// they are evaluated, while their cells are in cache, and never stored. visit() returns the worst decision
  /// value that the seed's plan leaves; -infinity where there is none. `seeds_a_source`: about how many
  /// each i has, by which few of them are shared among threads.
  template <class VisitSeeds>
  RoundCounts run(const Op& op, std::size_t n_sources, VisitSeeds&& visit_seeds, double seeds_a_source = 1) {
    op_ = &op;
    source_nanoseconds_ = seeds_a_source * seed_nanoseconds<Op>();
    const auto evaluate_seeds = [&] { return evaluate(n_sources, visit_seeds); };
    evaluate_ = {[](const void* context) { return (*static_cast<decltype(&evaluate_seeds)>(context))(); },
                 &evaluate_seeds};
    return RoundCore::run();
  }

  /// visit(plan, new vertex or invalid) for what the last run() committed, in rank order: for bookkeeping
  /// that is not the round's.
  template <class Visit>
  void for_committed(Visit&& visit) const {
    for (std::size_t w = 0; w < n_winners(); ++w) visit(candidates_[candidate_of(w)], new_vertex_of(w));
  }

 private:
  static constexpr int kPiecesAThread = 16;
  static constexpr double kPieceNanoseconds = 200'000;  // of dear seeds, so that threads end together
  using Plan = typename Op::Plan;

  static const Plan& own(const PlanBase& plan) { return static_cast<const Plan&>(plan); }
  std::size_t n_candidates() const override { return candidates_.size(); }
  const PlanBase& candidate(std::size_t i) const override { return candidates_[i]; }
  void scope(const PlanBase& plan, Scope& out) const override { op_->scope(mesh_, own(plan).seed, out); }
  void cavity(const PlanBase& plan, Cavity& out) const override { op_->cavity(mesh_, own(plan), out); }
  Tet identity(const PlanBase& plan) const override { return op_->identity(mesh_, own(plan).seed); }
  double quality(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const override { return op_->metric(a, b, c, d); }
  void measure(std::span<const CellHandle> cells) const override {
    for (CellHandle c : cells) {
      const auto& v = mesh_.cell(c).v;
      work_.quality[c.idx()] =
          op_->metric(mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), mesh_.point(v[3]));
    }
  }
  std::size_t evaluate() override { return evaluate_.call(evaluate_.context); }
  SeedAddress address(const PlanBase& plan) const override {
    if constexpr (HasAddress<typename Op::Seed>)
      return address_of(own(plan).seed);
    else
      throw InternalError("seeds of this operator have no address, so no round over parts of a mesh");
  }
  std::size_t add_candidate(const SeedAddress& at) override {
    if constexpr (HasAddress<typename Op::Seed>) {
      const std::optional<Plan> plan = op_->evaluate(mesh_, seed_at<typename Op::Seed>(at));
      if (!plan) throw InternalError("parts of a mesh differ: a winner of one improves nothing in another");
      candidates_.push_back(*plan);
    } else {
      static_cast<void>(at);
    }
    return candidates_.size() - 1;
  }

  template <class VisitSeeds>
  std::size_t evaluate(std::size_t n_sources, VisitSeeds&& visit_seeds) {
    // Seeds differ much in cost, so threads take pieces as they come; pieces are joined in their order.
    const int n_threads = par::thread_count(options_.policy.for_items_of(source_nanoseconds_), n_sources);
    if constexpr (EvaluatesInParts<Op>)
      if (options_.policy.threads > 1 &&
          n_sources < static_cast<std::size_t>(kPiecesAThread * options_.policy.threads))
        return evaluate_in_parts(n_sources, visit_seeds);
    const int n_pieces = n_threads == 1 ? 1 : n_pieces_for(n_threads, n_sources);
    std::vector<ChunkedArray<Plan>> found(static_cast<std::size_t>(n_pieces));
    std::vector<std::size_t> n_seeds(static_cast<std::size_t>(n_pieces), 0);
    const bool check = needs_admission();
    par::Policy pieces = options_.policy;
    pieces.serial_below = 0;
    par::for_each_dynamic(pieces, static_cast<std::size_t>(n_pieces), 1, [&](std::size_t piece) {
      Cavity cavity;
      Star scratch;
      std::size_t n = 0;
      auto& mine = found[piece];
      const std::size_t end = par::part_begin(n_sources, n_pieces, static_cast<int>(piece) + 1);
      for (std::size_t i = par::part_begin(n_sources, n_pieces, static_cast<int>(piece)); i < end; ++i) {
        visit_seeds(i, [&](typename Op::Seed seed) {
          ++n;
          const std::optional<Plan> plan = op_->evaluate(mesh_, seed);
          if (!plan || !may_be_committed(*plan, check, cavity, scratch))
            return -std::numeric_limits<double>::infinity();
          mine.push_back(*plan);
          return plan->new_worst;
        });
      }
      n_seeds[piece] = n;
    });
    candidates_ = std::move(found[0]);
    for (std::size_t p = 1; p < found.size(); ++p) candidates_.append(std::move(found[p]));
    return std::accumulate(n_seeds.begin(), n_seeds.end(), std::size_t{0});
  }

  int n_pieces_for(int n_threads, std::size_t n_sources) const {
    const auto dear = static_cast<std::size_t>(static_cast<double>(n_sources) *
                                               std::min(source_nanoseconds_ / kPieceNanoseconds, 1.0));
    return std::max(kPiecesAThread * n_threads, static_cast<int>(std::min<std::size_t>(dear, 1024)));
  }

  /// The same for few seeds that are dear: step by step, the parts of all seeds together.
  template <class VisitSeeds>
  std::size_t evaluate_in_parts(std::size_t n_sources, VisitSeeds&& visit_seeds) {
    struct Part {
      std::size_t seed, number;
    };
    std::vector<typename Op::Parts> seeds;
    for (std::size_t i = 0; i < n_sources; ++i)
      visit_seeds(i, [&](typename Op::Seed seed) { seeds.emplace_back(seed); });
    std::vector<Part> parts;
    par::Policy together = options_.policy;
    together.serial_below = 2;
    for (int step = 0; step == 0 || !parts.empty(); ++step) {
      parts.clear();
      for (std::size_t s = 0; s < seeds.size(); ++s)
        for (std::size_t n = op_->n_parts(seeds[s], step), i = 0; i < n; ++i) parts.push_back({s, i});
      par::for_each_dynamic(together, parts.size(), 1, [&](std::size_t i) {
        op_->evaluate_part(mesh_, seeds[parts[i].seed], step, parts[i].number);
      });
    }
    candidates_ = {};
    const bool check = needs_admission();
    Cavity cavity;
    Star scratch;
    for (const typename Op::Parts& one : seeds) {
      const std::optional<Plan> plan = op_->plan(mesh_, one);
      if (plan && may_be_committed(*plan, check, cavity, scratch)) candidates_.push_back(*plan);
    }
    return seeds.size();
  }

  const Op* op_ = nullptr;  // while run() lasts
  double source_nanoseconds_ = 0;
  struct {
    std::size_t (*call)(const void*) = nullptr;
    const void* context = nullptr;
  } evaluate_;
  ChunkedArray<Plan> candidates_;
};

}  // namespace hfr

#endif
