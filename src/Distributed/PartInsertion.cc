// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartInsertion.hh"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <unordered_set>
#include <utility>

#include "Distributed/Buffer.hh"
#include "Distributed/Cutout.hh"
#include "Distributed/PartRound.hh"
#include "Operators/VertexInsertion.hh"
#include "Scheduler/Round.hh"
#include "Scheduler/RoundPlace.hh"

namespace hfr::mpi {
namespace {

constexpr std::uint8_t kDeeper = 2;  // more layers round a cell whose cavity has come to the rim

/// A cell below the goal, as rank 0 sees it.
struct Poor {
  double quality = 0;
  std::uint64_t number = 0;
  std::array<std::uint64_t, 4> v{};
};

/// What a round does to the slots of the whole.
struct SlotChange {
  std::uint64_t n_taken = 0;     ///< from the back of the free list
  std::uint64_t n_fresh = 0;     ///< beyond it, at the end of all slots
  std::uint64_t n_vertices = 0;  ///< that come
};

/// What of one winner the other ranks need.
struct Change {
  std::vector<std::uint64_t> removed;
  std::vector<DistributedMesh::VertexRecord> vertices;
  std::vector<DistributedMesh::CellRecord> cells;
  std::vector<LabelRecord> labels;
};

/// The round on a cutout. Slots are those of the whole.
class CutoutRound : public RoundPlace {
 public:
  CutoutRound(Cutout& cutout, std::span<const std::uint64_t> free, std::uint64_t n_slots)
      : cutout_(cutout), free_(free), n_slots_(n_slots) {}

  std::uint64_t number(VertexHandle v) const override { return cutout_.number(v); }
  std::uint64_t number(CellHandle c) const override { return cutout_.number(c); }
  CellHandle slot(std::uint64_t number) override { return cutout_.add_slot(number); }
  Selected select(std::span<const Candidate> candidates, std::size_t may_lose, std::size_t may_gain) override;
  void finish(std::span<const Commit> commits) override;
  RoundCounts total(RoundCounts mine) override { return mine; }

  /// Whether an evaluation has come to the rim: then nothing was selected.
  bool has_met_rim() const { return has_met_rim_; }
  const SlotChange& slots() const { return slots_; }
  const std::vector<std::uint64_t>& freed() const { return freed_; }
  const std::vector<Change>& changes() const { return changes_; }

 private:
  Cutout& cutout_;
  std::span<const std::uint64_t> free_;  // of the whole, before the round
  std::uint64_t n_slots_;
  bool has_met_rim_ = false;
  SlotChange slots_;
  std::vector<std::uint64_t> freed_;  // in the order in which they go to the free list
  std::vector<Change> changes_;
};

/// In rank order, a candidate wins when no cell of its scope is taken and the bounds have room for it. Slots
/// as PartRound has them.
auto CutoutRound::select(std::span<const Candidate> candidates, std::size_t may_lose, std::size_t may_gain)
    -> Selected {
  Selected selected;
  const auto& met = cutout_.rim().has_met;
  has_met_rim_ = std::find(met.begin(), met.end(), 1) != met.end();
  if (has_met_rim_) return selected;
  static_cast<void>(may_lose);  // no vertex goes
  std::vector<std::uint8_t> is_taken(cutout_.mesh().n_cells(), 0);
  std::vector<std::size_t> won;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto scope = candidates[i].scope;
    if (std::any_of(scope.begin(), scope.end(), [&](CellHandle c) { return is_taken[c.idx()] != 0; }))
      continue;
    for (CellHandle c : scope) is_taken[c.idx()] = 1;
    won.push_back(i);
  }
  const auto gain = [&](std::size_t i) {
    const PlanBase& plan = *candidates[i].plan;
    return plan.n_created > plan.n_removed ? std::size_t{plan.n_created - plan.n_removed} : 0;
  };
  std::vector<std::uint64_t> back;
  for (std::size_t i : won) {
    if (gain(i) > may_gain) {
      ++selected.held_back;
      continue;
    }
    may_gain -= gain(i);
    const PlanBase& plan = *candidates[i].plan;
    Winner winner{i, candidates[i].seed, {}};
    for (std::size_t k = plan.n_removed; k < plan.n_created; ++k)
      winner.fresh.push_back(slots_.n_taken < free_.size() ? free_[free_.size() - ++slots_.n_taken]
                                                           : n_slots_ + slots_.n_fresh++);
    for (std::size_t k = plan.n_created; k < plan.n_removed; ++k)
      back.push_back(cutout_.number(candidates[i].scope[k]));
    ++slots_.n_vertices;
    selected.winners.push_back(std::move(winner));
  }
  freed_.assign(back.rbegin(), back.rend());
  return selected;
}

void CutoutRound::finish(std::span<const Commit> commits) {
  for (const Commit& commit : commits) {
    Change& change = changes_.emplace_back();
    for (CellHandle c : commit.removed) change.removed.push_back(cutout_.number(c));
    std::vector<VertexHandle> vertices;
    for (CellHandle c : commit.created) {
      change.cells.push_back(cutout_.record(c));
      const auto& v = cutout_.mesh().cell(c).v;
      vertices.insert(vertices.end(), v.begin(), v.end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (VertexHandle v : vertices) change.vertices.push_back(cutout_.record(v));
    change.labels = cutout_.labels_of(commit.created, vertices);
    change.vertices.back().owner = change.vertices.front().owner;  // the new one is the last of all
  }
}

/// The listed and the waiting cells that are still poor, on rank 0, in the order of numbers.
std::vector<Poor> gather_poor(DistributedMesh& parts, double below, const Worklist& list,
                              std::span<const std::uint64_t> waiting) {
  const TetMesh& part = parts.part();
  std::vector<Poor> poor;
  const auto add = [&](CellHandle c) {
    if (part.is_deleted(c) || !parts.is_own(c) || !(parts.work().quality[c.idx()] < below)) return;
    Poor& one = poor.emplace_back(Poor{parts.work().quality[c.idx()], parts.number(c), {}});
    for (std::size_t k = 0; k < 4; ++k) one.v[k] = parts.number(part.cell(c).v[k]);
  };
  for (Index c : list.cells()) add(CellHandle(c));
  for (std::uint64_t number : waiting)
    if (const CellHandle c = parts.cell_at(number); c.is_valid()) add(c);
  std::vector<Packer> to(parts.comm().n_ranks());
  to[0].put_all(poor);
  poor.clear();
  for (const Comm::Message& message : parts.comm().exchange(to)) {
    const auto theirs = Unpacker(message.bytes).get_all<Poor>();
    poor.insert(poor.end(), theirs.begin(), theirs.end());
  }
  const auto number = [](const Poor& a) { return a.number; };
  std::ranges::sort(poor, {}, number);
  const auto rest = std::ranges::unique(poor, {}, number);
  poor.erase(rest.begin(), rest.end());
  return poor;
}

/// What rank 0 has packed, on all of them.
std::vector<std::byte> told_by_first(Comm& comm, const Packer& said) {
  std::vector<Packer> to(comm.n_ranks());
  if (comm.rank() == 0) std::fill(to.begin(), to.end(), said);
  return std::move(comm.exchange(to).front().bytes);
}

/// The worst cells of which no two share a vertex get their turn now; the others wait. Both ascending.
struct Turns {
  std::vector<std::uint64_t> now, waiting;
};
Turns take_turns(Comm& comm, std::vector<Poor> poor) {
  std::ranges::stable_sort(poor, {}, [](const Poor& a) { return a.quality; });
  Turns turns;
  std::unordered_set<std::uint64_t> taken;
  for (const Poor& one : poor) {
    const bool is_free =
        std::none_of(one.v.begin(), one.v.end(), [&](std::uint64_t v) { return taken.contains(v); });
    if (is_free) taken.insert(one.v.begin(), one.v.end());
    (is_free ? turns.now : turns.waiting).push_back(one.number);
  }
  std::ranges::sort(turns.now);
  std::ranges::sort(turns.waiting);
  Packer said;
  said.put_all(turns.now);
  said.put_all(turns.waiting);
  const std::vector<std::byte> bytes = told_by_first(comm, said);
  Unpacker in(bytes);
  turns.now = in.get_all<std::uint64_t>();
  turns.waiting = in.get_all<std::uint64_t>();
  return turns;
}

/// Rank 0's part of the round. Packs what all ranks have to know: the cells whose cavities came to the rim,
/// and where there are none of these, what the round has done.
template <class M>
void run_on_cutout(DistributedMesh& parts, Cutout& cutout, const Ranks::Dig& dig, const Turns& turns,
                   const M& metric, Packer& said) {
  using Op = VertexInsertion<M>;
  CutoutRound place(cutout, parts.free_slots(), parts.n_slots());
  RoundOptions options{par::Policy{dig.look.threads}, /*check_links=*/false, dig.look.seed};
  options.may_lose = static_cast<std::size_t>(dig.look.may_lose);
  options.may_gain = static_cast<std::size_t>(dig.look.may_gain);
  options.place = &place;
  Op op{metric, cutout.work().quality, dig.gain};
  op.poor_below = dig.look.below;
  op.rim = &cutout.rim();
  if (turns.now.size() + turns.waiting.size() > dig.many) {
    op.max_sites = static_cast<std::size_t>(dig.sites_of_many);
    op.least_promise = dig.promise_of_many;
  }
  std::vector<typename Op::Seed> seeds;
  for (std::uint64_t number : turns.now) seeds.emplace_back(cutout.cell_at(number));
  Round<Op> round(cutout.mesh(), cutout.work(), options);
  const RoundCounts counts = round.run(op, seeds);
  std::vector<std::uint64_t> met;
  for (const typename Op::Seed& seed : seeds)
    if (cutout.rim().has_met[seed.cell.idx()] != 0) met.push_back(cutout.number(seed.cell));
  said.put_all(met);
  if (place.has_met_rim()) return;
  said.put(counts);
  said.put(place.slots());
  said.put_all(place.freed());
  said.put(static_cast<std::uint64_t>(place.changes().size()));
  for (const Change& change : place.changes()) {
    said.put_all(change.removed);
    said.put_all(change.vertices);
    said.put_all(change.cells);
    said.put_all(change.labels);
  }
}

/// What rank 0 has said of the round, into this part.
RoundCounts follow(DistributedMesh& parts, Unpacker& in) {
  const auto counts = in.get<RoundCounts>();
  const auto slots = in.get<SlotChange>();
  const auto freed = in.get_all<std::uint64_t>();
  std::vector<std::uint64_t>& free = parts.free_slots();
  free.resize(free.size() - slots.n_taken);
  free.insert(free.end(), freed.begin(), freed.end());
  parts.n_slots() += slots.n_fresh;
  parts.add_numbers(slots.n_vertices);
  ++parts.work().clock;
  std::vector<DistributedMesh::VertexRecord> vertices;
  std::vector<DistributedMesh::CellRecord> cells;
  std::vector<LabelRecord> labels;
  std::vector<CellHandle> gone;
  for (auto n = in.get<std::uint64_t>(); n > 0; --n) {
    const auto removed = in.get_all<std::uint64_t>();
    const auto v = in.get_all<DistributedMesh::VertexRecord>();
    const auto c = in.get_all<DistributedMesh::CellRecord>();
    const auto l = in.get_all<LabelRecord>();
    // Whoever has to hold one of the new cells holds one of those that they stand for.
    const std::size_t n_before = gone.size();
    for (std::uint64_t number : removed)
      if (const CellHandle held = parts.cell_at(number); held.is_valid() && !parts.part().is_deleted(held))
        gone.push_back(held);
    if (gone.size() == n_before) continue;
    vertices.insert(vertices.end(), v.begin(), v.end());
    cells.insert(cells.end(), c.begin(), c.end());
    labels.insert(labels.end(), l.begin(), l.end());
  }
  for (CellHandle c : gone) parts.detach(c);
  if (!gone.empty()) parts.apply(vertices, cells, labels);
  PartRound(parts).bring_near(!gone.empty());
  return counts;
}

template <class M>
RoundCounts insert(DistributedMesh& parts, const Ranks::Dig& dig, const Turns& turns,
                   std::uint8_t first_depth, const M& metric) {
  std::vector<std::uint8_t> depth(turns.now.size(), first_depth);
  for (;;) {
    Packer said;
    {
      Cutout cutout(parts, turns.now, depth);
      if (parts.comm().rank() == 0) run_on_cutout(parts, cutout, dig, turns, metric, said);
    }
    const std::vector<std::byte> bytes = told_by_first(parts.comm(), said);
    Unpacker in(bytes);
    const auto met = in.get_all<std::uint64_t>();
    if (met.empty()) return follow(parts, in);
    for (std::uint64_t number : met)
      depth[static_cast<std::size_t>(std::ranges::lower_bound(turns.now, number) - turns.now.begin())] +=
          kDeeper;
  }
}

}  // namespace

RoundCounts insert_in_parts(DistributedMesh& parts, const Ranks::Dig& dig, const Worklist& list,
                            std::vector<std::uint64_t>& waiting, std::uint8_t depth) {
  const auto n_own = static_cast<std::uint64_t>(
      std::ranges::count_if(list.cells(), [&](Index c) { return parts.is_own(CellHandle(c)); }));
  if (parts.comm().sum(n_own) == 0 && waiting.empty()) return {};
  Turns turns = take_turns(parts.comm(), gather_poor(parts, dig.look.below, list, waiting));
  waiting = turns.waiting;
  return dig.look.metric == Metric::kMinSine ? insert(parts, dig, turns, depth, MinSine2{})
                                             : insert(parts, dig, turns, depth, MinDihedral{});
}

}  // namespace hfr::mpi
