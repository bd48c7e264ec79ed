// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Improve.hh"

#ifdef __unix__
#include <sys/resource.h>
#endif

#include <algorithm>
#include <cmath>
#include <memory>

#include "Distributed/DistributedMesh.hh"
#include "Distributed/PartRound.hh"
#include "Distributed/PartSeeds.hh"
#include "Distributed/PartSmoothing.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"
#include "Operators/MultiFaceRemoval.hh"
#include "Operators/SmoothMaxMin.hh"
#include "Operators/VertexCollapse.hh"
#include "Remesh/PassState.hh"
#include "Remesh/Ranks.hh"
#include "Remesh/RunMemory.hh"
#include "Scheduler/PoorCells.hh"

namespace hfr::mpi {
namespace {

enum class Task : std::uint8_t { kTake, kPass, kTally, kBringBack, kFigures, kDismiss };

/// What rank 0 asks all ranks for.
struct Order {
  Task task{};
  Partition partition{};
  Ranks::Look look;
  double below = 0;
  int code = 0;
  int threads = 1;  // of the other ranks
};

/// Of this process; 0 where the system does not tell.
std::uint64_t peak_bytes() {
#ifdef __unix__
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
#endif
  return 0;
}

/// One rank of a run: does the orders that all ranks have at the same time.
class Worker {
 public:
  explicit Worker(Comm& comm) : comm_(comm) {}

  /// `mesh` and `work`: on rank 0 those of the run.
  void take(Partition how, const TetMesh* mesh, const Workspace* work, par::Policy policy) {
    parts_ = std::make_unique<DistributedMesh>(comm_);
    poor_ = {};
    std::vector<int> owner;
    {
      const Comm::InPhase phase(comm_, Phase::kCut);
      owner = partition(comm_, mesh, how);
    }
    const Comm::InPhase phase(comm_, Phase::kHandOut);
    parts_->scatter(mesh, work, owner, policy);
    count_part();
  }

  void bring_back(TetMesh* mesh, Workspace* work, par::Policy policy) {
    const Comm::InPhase phase(comm_, Phase::kPutTogether);
    parts_->gather(mesh, work, DistributedMesh::Gather::kChanged, policy);
    parts_.reset();
  }

  Ranks::Tally tally(double below) {
    const Comm::InPhase phase(comm_, Phase::kTally);
    std::array<std::uint64_t, 2> sums = {0, 0};
    double worst = std::numeric_limits<double>::infinity();
    const TetMesh& part = parts_->part();
    for (std::size_t i = 0; i < part.n_cells(); ++i) {
      const double q = parts_->work().quality[i];
      // Deleted ones and most others are nowhere near.
      if (q > 0 && !(q < below) && !(q < worst)) continue;
      const CellHandle c(i);
      if (part.is_deleted(c) || !parts_->is_own(c)) continue;
      sums[0] += q > 0 ? 0 : 1;
      sums[1] += q < below ? 1 : 0;
      worst = std::min(worst, q);
    }
    worst = comm_.sum_and_min(sums, worst);
    return {static_cast<std::size_t>(sums[0]), static_cast<std::size_t>(sums[1]), worst};
  }

  RoundCounts pass(const Ranks::Look& look) {
    const Comm::InPhase phase(comm_, Phase::kEvaluate);
    return look.metric == Metric::kMinSine ? pass(look, MinSine2{}) : pass(look, MinDihedral{});
  }

  std::size_t n_cells() const { return static_cast<std::size_t>(parts_->n_cells()); }

  /// Of all ranks.
  std::vector<RankFigures> figures() {
    figures_.traffic = comm_.traffic();
    figures_.seconds = comm_.seconds();
    figures_.peak_bytes = peak_bytes();
    return comm_.all_gather(std::span<const RankFigures>(&figures_, 1));
  }

 private:
  void count_part() {
    const TetMesh& part = parts_->part();
    figures_.n_held = part.n_cells();
    figures_.n_border = parts_->zone().size();
    figures_.n_own = 0;
    for (std::size_t c = 0; c < part.n_cells(); ++c) figures_.n_own += parts_->is_own(CellHandle(c)) ? 1 : 0;
  }

  template <class M>
  RoundCounts pass(const Ranks::Look& look, const M& metric) {
    const TetMesh& part = parts_->part();
    Workspace& work = parts_->work();
    const par::Policy policy{look.threads};
    const Worklist list(part, policy, poor_.below(look.below, work, policy), [&](CellHandle c) {
      const auto& v = part.cell(c).v;
      return std::any_of(v.begin(), v.end(),
                         [&](VertexHandle u) { return work.changed[u.idx()] > look.since; });
    });
    std::array<std::uint64_t, 2> listed = {list.cells().size(), 0};
    if (look.kind == PassKind::kEdge) listed[1] = n_own(list.cells());
    comm_.sum(listed);
    if (listed[0] == 0) return {};
    ++figures_.n_rounds;
    switch (look.kind) {
      case PassKind::kEdge:
        return round<EdgeRemoval<M>>(look, {metric, work.quality}, list, listed[1] > look.first_edge_beyond);
      case PassKind::kFace:
        return round<FaceSwap<M>>(look, {metric, work.quality}, list);
      case PassKind::kMultiFace:
        return round<MultiFaceRemoval<M>>(look, {metric, work.quality}, list);
      case PassKind::kNode: {
        using Op = VertexCollapse<M>;
        PartRound place(*parts_);
        Round<Op> round(parts_->part(), work, options(look, place));
        return round.run(Op{metric, work.quality, work.frozen}, removable_seeds(*parts_, list, policy));
      }
      default: {
        const auto vertices = vertex_seeds(part, list, work.frozen, policy);
        const auto n_own = std::count_if(vertices.begin(), vertices.end(),
                                         [&](VertexHandle v) { return parts_->is_own(v); });
        if (comm_.sum(static_cast<std::uint64_t>(n_own)) == 0) return {};
        const Comm::InPhase phase(comm_, Phase::kSmooth);
        return smooth_parts(*parts_, MaxMinSearch{}, metric, vertices, policy);
      }
    }
  }

  static RoundOptions options(const Ranks::Look& look, PartRound& place) {
    RoundOptions options{par::Policy{look.threads}, /*check_links=*/false, look.seed};
    options.may_lose = static_cast<std::size_t>(look.may_lose);
    options.may_gain = static_cast<std::size_t>(look.may_gain);
    return place.options(options);
  }

  template <class Op>
  RoundCounts round(const Ranks::Look& look, const Op& op, const Worklist& list, bool first_does = false) {
    PartRound place(*parts_);
    Round<Op> round(parts_->part(), parts_->work(), options(look, place));
    return round.run(op, list.cells().size(), [&](std::size_t i, auto&& visit) {
      const CellHandle c(list.cells()[i]);
      if constexpr (!std::is_same_v<typename Op::Seed, EdgeHandle>)
        visit_face_seeds(*parts_, list, c, [&](HalfFaceHandle h) { visit(typename Op::Seed(h)); });
      else if (first_does)
        visit_edge_seeds_until(*parts_, list, c, [&](EdgeHandle e) { return visit(e) >= look.below; });
      else
        visit_edge_seeds(*parts_, list, c, visit);
    });
  }

  /// Of these cells of the part, how many are own ones.
  std::uint64_t n_own(std::span<const Index> cells) const {
    return static_cast<std::uint64_t>(
        std::count_if(cells.begin(), cells.end(), [&](Index c) { return parts_->is_own(CellHandle(c)); }));
  }

  Comm& comm_;
  std::unique_ptr<DistributedMesh> parts_;
  PoorCells poor_;  // of the part
  RankFigures figures_;
};

void tell(Comm& comm, const Order& order) { comm.from_first(order); }

/// Rank 0: tells the others, and does its own share.
class Conductor : public Ranks {
 public:
  /// `alone`: while the others wait.
  Conductor(Comm& comm, const Sharing& sharing, par::Policy alone)
      : comm_(comm), sharing_(sharing), alone_(alone), worker_(comm) {}

  bool can_do(PassKind kind, Metric metric) const override {
    return (metric == Metric::kMinSine || metric == Metric::kMinDihedral) &&
           (kind == PassKind::kEdge || kind == PassKind::kFace || kind == PassKind::kMultiFace ||
            kind == PassKind::kNode || kind == PassKind::kSmooth);
  }
  bool can_take(const TetMesh& mesh, const Workspace& work) const override {
    return DistributedMesh::reason_against(mesh, work).empty();
  }
  std::size_t least_cells(std::size_t n_cells) const override {
    const std::size_t part = sharing_.least_one_in == 0 ? 0 : n_cells / sharing_.least_one_in;
    return std::max(sharing_.least_cells, part);
  }
  void take(const TetMesh& mesh, const Workspace& work) override {
    tell(comm_, {Task::kTake, sharing_.partition, {}, 0, 0, threads()});
    worker_.take(sharing_.partition, &mesh, &work, alone_);
  }
  RoundCounts pass(const Look& look) override {
    Look shared = look;
    shared.threads = threads();
    tell(comm_, {Task::kPass, {}, shared, 0, 0});
    return worker_.pass(shared);
  }
  Tally tally(double below) override {
    tell(comm_, {Task::kTally, {}, {}, below, 0});
    return worker_.tally(below);
  }
  std::size_t n_cells() const override { return worker_.n_cells(); }
  void bring_back(TetMesh& mesh, Workspace& work) override {
    tell(comm_, {Task::kBringBack, {}, {}, 0, 0, threads()});
    worker_.bring_back(&mesh, &work, alone_);
  }
  void tell_figures() {
    if (!sharing_.tell_figures) return;
    tell(comm_, {Task::kFigures, {}, {}, 0, 0});
    sharing_.tell_figures(worker_.figures());
  }

 private:
  /// Of each rank in what all do.
  int threads() const { return sharing_.threads > 0 ? sharing_.threads : alone_.threads; }

  Comm& comm_;
  Sharing sharing_;
  par::Policy alone_;
  Worker worker_;
};

}  // namespace

Result improve(TetMesh& mesh, const ImproveOptions& options, Comm& comm, const Sharing& sharing) {
  HFR_REQUIRE(comm.rank() == 0, "hfr::mpi::improve() is called by rank 0; the others call serve()");
  RunMemory memory;
  Conductor conductor(comm, sharing, options.policy);
  if (comm.size() > 1) memory.ranks = &conductor;
  Result result = hfr::improve(mesh, options, memory);
  conductor.tell_figures();
  return result;
}

int serve(Comm& comm) {
  HFR_REQUIRE(comm.rank() != 0, "hfr::mpi::serve() is for all ranks but 0");
  Worker worker(comm);
  while (true) {
    const Order order = comm.from_first(Order{});
    switch (order.task) {
      case Task::kTake:
        worker.take(order.partition, nullptr, nullptr, {order.threads});
        break;
      case Task::kPass:
        worker.pass(order.look);
        break;
      case Task::kTally:
        worker.tally(order.below);
        break;
      case Task::kBringBack:
        worker.bring_back(nullptr, nullptr, {order.threads});
        break;
      case Task::kFigures:
        worker.figures();
        break;
      case Task::kDismiss:
        return order.code;
    }
  }
}

void dismiss(Comm& comm, int code) { tell(comm, {Task::kDismiss, {}, {}, 0, code}); }

}  // namespace hfr::mpi
