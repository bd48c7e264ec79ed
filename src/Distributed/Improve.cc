// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/Improve.hh"

#include <algorithm>
#include <memory>
#include <optional>

#include "Distributed/DistributedMesh.hh"
#include "Distributed/PartPasses.hh"
#include "Remesh/PassState.hh"
#include "Remesh/Ranks.hh"
#include "Remesh/RunMemory.hh"

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

/// One rank of a run: does the orders that all ranks have at the same time.
class Worker {
 public:
  explicit Worker(Comm& comm) : comm_(comm) {}

  /// `mesh` and `work`: on rank 0 those of the run.
  void take(Partition how, const TetMesh* mesh, const Workspace* work, par::Policy policy) {
    passes_.reset();
    parts_ = std::make_unique<DistributedMesh>(comm_);
    passes_.emplace(*parts_, figures_.n_rounds);
    std::vector<int> owner;
    {
      const Comm::InPhase phase(comm_, Phase::kCut);
      owner = partition(comm_, mesh, how);
    }
    const Comm::InPhase phase(comm_, Phase::kHandOut);
    parts_->scatter(mesh, work, owner, policy);
    look_at_part(*parts_, figures_);
  }

  void bring_back(TetMesh* mesh, Workspace* work, par::Policy policy) {
    const Comm::InPhase phase(comm_, Phase::kPutTogether);
    parts_->gather(mesh, work, DistributedMesh::Gather::kChanged, policy);
    passes_.reset();
    parts_.reset();
  }

  Ranks::Tally tally(double below) { return passes_->tally(below); }
  RoundCounts pass(const Ranks::Look& look) { return passes_->run(look); }

  std::size_t n_cells() const { return static_cast<std::size_t>(parts_->n_cells()); }

  /// Of all ranks.
  std::vector<RankFigures> figures() const { return gather_figures(comm_, figures_); }

 private:
  Comm& comm_;
  std::unique_ptr<DistributedMesh> parts_;
  std::optional<PartPasses> passes_;
  RankFigures figures_;
};

void tell(Comm& comm, const Order& order) { comm.from_first(order); }

/// Rank 0: tells the others, and does its own share.
class Conductor : public Ranks {
 public:
  /// `alone`: while the others wait.
  Conductor(Comm& comm, const Sharing& sharing, par::Policy alone)
      : comm_(comm), sharing_(sharing), alone_(alone), worker_(comm) {}

  bool can_do(PassKind kind, const RankMetric& metric) const override {
    return metric.metric != Metric::kVolumeLength && PartPasses::can_do(kind, metric);
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
