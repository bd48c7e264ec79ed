// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartRound.hh"

#include <algorithm>
#include <tuple>

#include "Distributed/WholeStars.hh"
#include "HalfFace/Writer.hh"
#include "Scheduler/Select.hh"

namespace hfr::mpi {
namespace {

template <class T>
void sort_and_unite(std::vector<T>& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

std::vector<VertexHandle> vertices_of(const TetMesh& mesh, std::span<const CellHandle> cells) {
  std::vector<VertexHandle> vertices;
  for (CellHandle c : cells)
    for (VertexHandle v : mesh.cell(c).v) vertices.push_back(v);
  sort_and_unite(vertices);
  return vertices;
}

/// A candidate as it is told to other ranks; the numbers of its scope's cells follow.
struct Announcement {
  std::uint64_t key = 0;
  SeedName name{};
  std::uint64_t seed_cell = kNoNumber, seed_vertex = kNoNumber;
  std::uint32_t seed_place = 0, seed_kind = 0, number = 0, n_cells = 0;
};

/// A candidate as rank 0 hears of it where nothing may be made twice; its cells and what it makes follow.
struct Contender {
  std::uint64_t key = 0;
  SeedName name{};
  std::uint64_t seed_number = 0;
  std::uint32_t seed_place = 0, number = 0;
};

auto by_rank_order(const Contender& c) { return std::tie(c.key, c.name, c.seed_number, c.seed_place); }

/// Of number `number` of that rank's.
std::uint64_t candidate_name(int rank, std::uint32_t number) {
  return (static_cast<std::uint64_t>(rank) << 32U) | number;
}

struct Decision {
  std::uint32_t number = 0;
  std::uint32_t has_won = 0;
};

}  // namespace

std::uint64_t PartRound::seed_number(const Entry& entry) const {
  if (!is_own(entry)) return others_[entry.other].seed_number;
  const SeedAddress at = candidates_->seed(entry.own);
  return at.cell.is_valid() ? mesh_.number(at.cell) : mesh_.number(at.vertex);
}

bool PartRound::is_before(const Entry& a, const Entry& b) const {
  if (key(a) != key(b)) return key(a) < key(b);
  if (name(a) != name(b)) return name(a) < name(b);
  return std::tuple(seed_number(a), seed(a).place) < std::tuple(seed_number(b), seed(b).place);
}

auto PartRound::select(const Candidates& candidates, std::size_t may_lose, std::size_t may_gain,
                       bool forbids_twice) -> Selected {
  const Comm::InPhase phase(comm_, Phase::kSelect);
  candidates_ = &candidates;
  if (forbids_twice)
    for (std::size_t i = 0; i < candidates.size(); ++i) made_.push_back(candidates.made(i));
  const Heard heard = announce();
  if (heard.makes_any)
    decide_on_first();
  else
    decide(heard.is_anyone_told);
  Selected selected;
  for (const Entry& entry : entries_)
    if (entry.state == State::kWon)
      selected.winners.push_back({is_own(entry) ? entry.own : Winner::kOfOthers, seed(entry), {}});
  selected.held_back = hand_out_slots(may_lose, may_gain, selected.winners);
  pending_.clear();
  std::size_t w = 0;
  for (const Entry& entry : entries_) {
    if (entry.state != State::kWon) continue;
    note_pending(w++, entry);
    if (tell_)
      places_.push_back({key(entry), name(entry), seed_number(entry), seed(entry).place, is_own(entry)});
  }
  entries_ = {};
  told_ = {};
  others_ = {};
  made_ = {};
  candidates_ = nullptr;
  return selected;
}

/// Tells each rank of the candidates that have a vertex within one edge of its own ones: those are all that
/// share a cell with a candidate of that rank, and all that it has to commit.
auto PartRound::announce() -> Heard {
  const TetMesh& part = mesh_.part();
  std::vector<Packer> to(comm_.n_ranks());
  entries_.resize(candidates_->size());
  RankSet told(mesh_.within_two().words());
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& entry = entries_[i];
    entry.own = static_cast<std::uint32_t>(i);
    const auto cells = scope(entry);
    if (std::none_of(cells.begin(), cells.end(), [&](CellHandle c) { return mesh_.is_in_zone(c); })) continue;
    told.clear();
    for (CellHandle c : cells)
      for (VertexHandle v : part.cell(c).v) told.add(mesh_.near(v));
    told.remove(comm_.rank());
    if (told.empty()) continue;
    const SeedAddress at = seed(entry);
    Announcement a{key(entry), name(entry), kNoNumber, kNoNumber,
                   at.place,   at.kind,     entry.own, static_cast<std::uint32_t>(cells.size())};
    if (at.cell.is_valid()) a.seed_cell = mesh_.number(at.cell);
    if (at.vertex.is_valid()) a.seed_vertex = mesh_.number(at.vertex);
    for_ranks(told.bits(), [&](int r) {
      Packer& out = to[static_cast<std::size_t>(r)];
      out.put(a);
      for (CellHandle c : cells) out.put(mesh_.number(c));
    });
    entry.other = static_cast<std::uint32_t>(told_.size());
    told_.push_back(told);
  }
  const bool makes_some = std::any_of(made_.begin(), made_.end(), [](const auto& m) { return !m.empty(); });
  const Comm::Exchanged came = comm_.exchange(to, makes_some ? 1 : 0);
  for (const Comm::Message& message : came.messages) hear(message);
  const auto before = [&](const Entry& a, const Entry& b) { return is_before(a, b); };
  const auto middle = entries_.begin() + static_cast<std::ptrdiff_t>(candidates_->size());
  if (!std::is_sorted(entries_.begin(), middle, before)) std::sort(entries_.begin(), middle, before);
  if (middle != entries_.end()) {
    std::sort(middle, entries_.end(), before);
    std::inplace_merge(entries_.begin(), middle, entries_.end(), before);
  }
  return {came.n_messages > 0, came.sum > 0};
}

void PartRound::hear(const Comm::Message& message) {
  Unpacker in(message.bytes);
  while (!in.at_end()) {
    const auto a = in.get<Announcement>();
    OfOther one;
    one.key = a.key;
    one.name = a.name;
    one.home = message.from;
    one.number_at_home = a.number;
    one.seed.place = a.seed_place;
    one.seed.kind = a.seed_kind;
    one.seed_number = a.seed_cell != kNoNumber ? a.seed_cell : a.seed_vertex;
    if (a.seed_cell != kNoNumber) one.seed.cell = mesh_.cell_at(a.seed_cell);
    if (a.seed_vertex != kNoNumber) one.seed.vertex = mesh_.vertex_at(a.seed_vertex);
    for (std::uint32_t i = 0; i < a.n_cells; ++i) {
      const CellHandle c = mesh_.cell_at(in.get<std::uint64_t>());
      if (!c.is_valid() || mesh_.part().is_deleted(c))
        throw InternalError(
            "parts of a mesh differ: a candidate next to this part has a cell that is not here");
      one.scope.push_back(c);
    }
    entries_.push_back({kNothing, static_cast<std::uint32_t>(others_.size()), State::kUndecided});
    others_.push_back(std::move(one));
  }
}

/// Until all ranks know of all their candidates: decides what the decisions of others allow, and tells those
/// who wait for it. The first undecided candidate of the whole is decided each time.
void PartRound::decide(bool is_anyone_told) {
  undecided_.resize(entries_.size());
  for (std::size_t e = 0; e < entries_.size(); ++e) undecided_[e] = static_cast<std::uint32_t>(e);
  sub_rounds_ = 0;
  for (bool is_done = false; !is_done;) {
    ++sub_rounds_;
    sweep();
    std::uint64_t n_left = 0;
    for (std::uint32_t e : undecided_)
      if (is_own(entries_[e]) && entries_[e].state == State::kUndecided) ++n_left;
    is_done = !is_anyone_told || tell_decisions(n_left) == 0;
    for (std::uint32_t e : undecided_)
      if (!is_own(entries_[e]) && entries_[e].state == State::kWon)
        for (CellHandle c : scope(entries_[e])) mesh_.work().claim[c.idx()] = e;
    std::erase_if(undecided_, [&](std::uint32_t e) { return entries_[e].state != State::kUndecided; });
  }
  if (!undecided_.empty()) throw InternalError("a selection among ranks has ended without a decision");
  for (const Entry& entry : entries_)
    if (entry.state == State::kWon)
      for (CellHandle c : scope(entry)) mesh_.work().claim[c.idx()] = kUnclaimed;
}

/// Two candidates that make the same edge may lie further from each other than ranks know of candidates. So
/// rank 0 goes through those of all, as select_by_marking() does.
void PartRound::decide_on_first() {
  sub_rounds_ = 1;
  std::vector<Packer> to(comm_.n_ranks());
  for (const Entry& entry : entries_) {
    if (!is_own(entry)) continue;
    to[0].put(Contender{key(entry), name(entry), seed_number(entry), seed(entry).place, entry.own});
    std::vector<std::uint64_t> cells;
    for (CellHandle c : scope(entry)) cells.push_back(mesh_.number(c));
    to[0].put_all(cells);
    to[0].put_all(made_[entry.own]);
  }
  struct Met {
    Contender contender;
    int home = 0;
    std::vector<std::uint64_t> cells, made;
  };
  std::vector<Met> all;
  for (const Comm::Message& message : comm_.exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) {
      Met& one = all.emplace_back();
      one.contender = in.get<Contender>();
      one.home = message.from;
      one.cells = in.get_all<std::uint64_t>();
      one.made = in.get_all<std::uint64_t>();
    }
  std::sort(all.begin(), all.end(), [](const Met& a, const Met& b) {
    return by_rank_order(a.contender) < by_rank_order(b.contender);
  });
  std::vector<std::uint64_t> won;
  std::unordered_set<std::uint64_t> taken, made;
  for (const Met& one : all) {
    const bool is_free =
        std::none_of(one.cells.begin(), one.cells.end(), [&](std::uint64_t c) { return taken.contains(c); });
    if (!is_free || !add_unless_there(one.made, made)) continue;
    taken.insert(one.cells.begin(), one.cells.end());
    won.push_back(candidate_name(one.home, one.contender.number));
  }
  std::sort(won.begin(), won.end());
  Packer said;
  said.put_all(won);
  const std::vector<std::byte> bytes = told_by_first(comm_, said);
  won = Unpacker(bytes).get_all<std::uint64_t>();
  for (Entry& entry : entries_) {
    const std::uint64_t named =
        is_own(entry) ? candidate_name(comm_.rank(), entry.own)
                      : candidate_name(others_[entry.other].home, others_[entry.other].number_at_home);
    const bool has_won = std::binary_search(won.begin(), won.end(), named);
    entry.state = has_won ? State::kWon : State::kLost;
  }
}

/// In rank order: a candidate has lost when a winner has one of its cells, and waits while one that is
/// undecided has. Claims of winners stay.
void PartRound::sweep() {
  auto& claim = mesh_.work().claim;
  for (std::uint32_t e : undecided_) {
    Entry& entry = entries_[e];
    bool is_free = true, has_lost = false;
    for (CellHandle c : scope(entry)) {
      const std::uint32_t holder = claim[c.idx()];
      if (holder == kUnclaimed) continue;
      is_free = false;
      has_lost = has_lost || entries_[holder].state == State::kWon;
    }
    if (has_lost) {
      if (is_own(entry)) entry.state = State::kLost;
      continue;
    }
    if (is_free && is_own(entry)) entry.state = State::kWon;
    for (CellHandle c : scope(entry))
      if (claim[c.idx()] == kUnclaimed) claim[c.idx()] = e;
  }
  for (std::uint32_t e : undecided_)
    if (entries_[e].state == State::kUndecided)
      for (CellHandle c : scope(entries_[e]))
        if (claim[c.idx()] == e) claim[c.idx()] = kUnclaimed;
}

/// Returns the sum of `n_left` over all ranks.
std::uint64_t PartRound::tell_decisions(std::uint64_t n_left) {
  std::vector<Packer> to(comm_.n_ranks());
  // Of others' candidates, those that are undecided, by rank and number.
  std::vector<std::tuple<int, std::uint32_t, std::uint32_t>> waiting;
  for (std::uint32_t e : undecided_) {
    const Entry& entry = entries_[e];
    if (!is_own(entry)) {
      waiting.emplace_back(others_[entry.other].home, others_[entry.other].number_at_home, e);
      continue;
    }
    if (entry.state == State::kUndecided || entry.other == kNothing) continue;
    const Decision decision{entry.own, entry.state == State::kWon ? 1U : 0U};
    for_ranks(told_[entry.other].bits(), [&](int r) { to[static_cast<std::size_t>(r)].put(decision); });
  }
  std::sort(waiting.begin(), waiting.end());
  const Comm::Exchanged came = comm_.exchange(to, n_left);
  for (const Comm::Message& message : came.messages) {
    Unpacker in(message.bytes);
    while (!in.at_end()) {
      const auto decision = in.get<Decision>();
      const auto at = std::lower_bound(waiting.begin(), waiting.end(),
                                       std::tuple(message.from, decision.number, std::uint32_t{0}));
      if (at == waiting.end() || std::get<0>(*at) != message.from || std::get<1>(*at) != decision.number)
        throw InternalError("a decision among ranks is about a candidate that nobody has told of");
      entries_[std::get<2>(*at)].state = decision.has_won ? State::kWon : State::kLost;
    }
  }
  return came.sum;
}

/// Slots as the round in shared memory has them: in rank order, from the back of the free list, then new
/// ones; what is freed goes to its back. Every rank goes through the winners of all that take or leave a
/// slot. Returns the number of winners that are given up, because the whole would lose or gain too many
/// cells.
std::size_t PartRound::hand_out_slots(std::size_t may_lose, std::size_t may_gain,
                                      std::vector<Winner>& winners) {
  std::vector<SlotUse> mine;
  std::vector<std::uint64_t> my_freed;
  for (const Entry& entry : entries_) {
    if (entry.state != State::kWon || !is_own(entry)) continue;
    const PlanBase& plan = candidates_->plan(entry.own);
    SlotUse use{key(entry), name(entry)};
    for (const CavityPart& p :
         parts_of(plan.n_removed, plan.n_created, plan.n_removed_first, plan.n_created_first)) {
      for (std::size_t i = p.n_created; i < p.n_removed; ++i, ++use.n_freed)
        my_freed.push_back(mesh_.number(scope(entry)[p.first_removed + i]));
      if (p.n_created > p.n_removed) use.n_fresh += static_cast<std::uint32_t>(p.n_created - p.n_removed);
    }
    if (plan.removes_vertex && plan.n_removed > plan.n_created) use.loss = plan.n_removed - plan.n_created;
    if (plan.adds_vertex && plan.n_created > plan.n_removed) use.gain = plan.n_created - plan.n_removed;
    if (use.n_fresh + use.n_freed + use.loss + use.gain > 0) mine.push_back(use);
  }
  const auto gathered = gather_uses(mine, my_freed);
  const auto& uses = gathered.uses;
  const auto& freed = gathered.freed;
  std::vector<std::size_t> order(uses.size()), first_freed(uses.size());
  std::size_t n_freed = 0, lost = 0, gained = 0;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    order[i] = i;
    first_freed[i] = n_freed;
    n_freed += uses[i].n_freed;
    lost += uses[i].loss;
    gained += uses[i].gain;
  }
  const auto rank_of = [](const SlotUse& use) { return std::tie(use.key, use.name); };
  const auto compare = [&](const Entry& entry, const SlotUse& use) {
    const auto by_key = key(entry) <=> use.key;
    return by_key != 0 ? by_key : name(entry) <=> use.name;
  };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return rank_of(uses[a]) < rank_of(uses[b]); });
  const bool all_stay = lost <= may_lose && gained <= may_gain;
  std::vector<std::uint64_t> back;  // to the free list
  std::size_t n_given_up = 0, w = 0, e = 0;
  std::vector<std::size_t> given_up;
  const auto skip = [&] {  // to the next winner that is committed here
    while (e < entries_.size() && entries_[e].state != State::kWon) ++e;
  };
  for (std::size_t i : order) {
    const SlotUse& use = uses[i];
    for (skip(); e < entries_.size() && compare(entries_[e], use) < 0; skip()) ++e, ++w;
    const bool is_here = e < entries_.size() && compare(entries_[e], use) == 0;
    if (!all_stay && (use.loss > may_lose || use.gain > may_gain)) {
      ++n_given_up;
      if (is_here) given_up.push_back(w), dropped_.push_back(e);
      continue;
    }
    if (!all_stay) may_lose -= use.loss, may_gain -= use.gain;
    for (std::uint32_t k = 0; k < use.n_fresh; ++k) {
      std::uint64_t slot = mesh_.n_slots();
      if (mesh_.free_slots().empty()) {
        ++mesh_.n_slots();
      } else {
        slot = mesh_.free_slots().back();
        mesh_.free_slots().pop_back();
      }
      if (is_here) winners[w].fresh.push_back(slot);
    }
    for (std::uint32_t k = 0; k < use.n_freed; ++k) back.push_back(freed[first_freed[i] + k]);
  }
  mesh_.free_slots().insert(mesh_.free_slots().end(), back.rbegin(), back.rend());
  for (std::uint64_t gone : dropped_) entries_[gone].state = State::kLost;
  dropped_.clear();
  std::size_t n_kept = 0;
  for (std::size_t i = 0, next = 0; i < winners.size(); ++i) {
    if (next < given_up.size() && given_up[next] == i) {
      ++next;
      continue;
    }
    if (n_kept != i) winners[n_kept] = std::move(winners[i]);
    ++n_kept;
  }
  winners.erase(winners.begin() + static_cast<std::ptrdiff_t>(n_kept), winners.end());
  return n_given_up;
}

/// Of all ranks, in their order.
auto PartRound::gather_uses(std::span<const SlotUse> mine, std::span<const std::uint64_t> freed) -> Uses {
  Packer out;
  if (!mine.empty()) {
    out.put_all(mine);
    out.put_all(freed);
  }
  const std::vector<std::byte> bytes = comm_.all_gather(std::span<const std::byte>(out.bytes()));
  Uses all;
  for (Unpacker in(bytes); !in.at_end();) {
    const auto uses = in.get_all<SlotUse>();
    all.uses.insert(all.uses.end(), uses.begin(), uses.end());
    const auto theirs = in.get_all<std::uint64_t>();
    all.freed.insert(all.freed.end(), theirs.begin(), theirs.end());
  }
  return all;
}

/// Before the commit: whose cells the winner takes away. A rank answers for the cells round its own vertices.
void PartRound::note_pending(std::size_t winner, const Entry& entry) {
  const auto cells = scope(entry);
  if (std::none_of(cells.begin(), cells.end(), [&](CellHandle c) { return mesh_.is_in_zone(c); })) return;
  Pending pending;
  pending.winner = winner;
  pending.vertices = vertices_of(mesh_.part(), cells);
  pending.receivers = RankSet(mesh_.within_two().words());
  for (VertexHandle v : pending.vertices)
    if (mesh_.is_own(v)) pending.receivers.add(mesh_.within_two(v));
  pending.receivers.remove(comm_.rank());
  pending_.push_back(std::move(pending));
}

void PartRound::finish(std::span<const Commit> commits) {
  const Comm::InPhase phase(comm_, Phase::kBorder);
  if (tell_) tell_(places_);
  for (const Pending& one : pending_) {
    mesh_.note_changed(one.vertices);
    for (CellHandle c : commits[one.winner].created) mesh_.note_created(c);
  }
  bool is_touched = !pending_.empty();
  // First what has changed, to whoever held it: then each rank knows all cells round the vertices that were
  // within two edges of its own. An edge that came may have brought vertices nearer, but only such; so it
  // knows whom its own are near to now.
  const Outcome first = exchange(changed_cells(commits), commits, is_touched);
  is_touched = is_touched || first.has_come;
  if (!first.is_any_touched) return;  // nowhere
  bring_near(is_touched, commits);
}

/// In the first step each rank knows all cells round its own vertices, in the second also those round their
/// neighbours, hence whom its own are within two edges of.
void PartRound::bring_near(bool is_touched, std::span<const Commit> commits, bool is_far) {
  bool is_new = is_touched;
  for (int step = is_far ? 2 : 1; step > 0; --step) {
    if (is_new) mesh_.update_zone();
    is_new = exchange(is_new ? new_cells() : std::vector<Push>(comm_.n_ranks()), commits, false).has_come;
    is_touched = is_touched || is_new;
    if (step > 1) mesh_.note_told();
  }
  if (is_new) mesh_.update_zone();
  if (!is_touched) return;
  mesh_.prune();
  mesh_.note_told();
}

/// For each rank that held what has changed round own vertices: the slots that went, the cells that came, and
/// the vertices.
auto PartRound::changed_cells(std::span<const Commit> commits) const -> std::vector<Push> {
  const TetMesh& part = mesh_.part();
  std::vector<Push> pushes(comm_.n_ranks());
  RankSet set(mesh_.within_two().words());
  for (const Pending& one : pending_) {
    const Commit& commit = commits[one.winner];
    for_others(one.receivers.bits(), pushes, [&](Push& push) {
      for (CellHandle c : commit.removed) push.removed.push_back(mesh_.number(c));
    });
    for (CellHandle c : commit.created) {
      set.clear();
      for (VertexHandle v : part.cell(c).v)
        if (mesh_.is_own(v)) set.add(mesh_.told(v));
      for_others(set.bits(), pushes, [&](Push& push) { push.cells.push_back(c); });
    }
    for (VertexHandle v : one.vertices)
      if (mesh_.is_own(v) && !part.is_deleted(v))
        for_others(mesh_.told(v), pushes, [&](Push& push) { push.vertices.push_back(v); });
  }
  return pushes;
}

/// For each rank: all cells round own vertices that have come within two edges of its own.
auto PartRound::new_cells() const -> std::vector<Push> {
  std::vector<Push> pushes(comm_.n_ranks());
  RankSet now(mesh_.within_two().words());
  WholeStars stars(mesh_.part(), mesh_.work());
  for (VertexHandle v : mesh_.renewed()) {
    if (mesh_.part().is_deleted(v)) continue;
    now.clear();
    now.add(mesh_.within_two(v));
    now.remove(mesh_.told(v));
    if (now.empty()) continue;
    stars.for_cells(v, [&](CellHandle c) {
      for_others(now.bits(), pushes, [&](Push& push) { push.cells.push_back(c); });
    });
  }
  return pushes;
}

/// Sends these and writes what comes.
auto PartRound::exchange(std::vector<Push>&& pushes, std::span<const Commit> commits, bool is_touched)
    -> Outcome {
  std::vector<Packer> to(comm_.n_ranks());
  for (std::size_t r = 0; r < pushes.size(); ++r) {
    Push& push = pushes[r];
    sort_and_unite(push.cells);
    for (CellHandle c : push.cells)
      for (VertexHandle v : mesh_.part().cell(c).v) push.vertices.push_back(v);
    sort_and_unite(push.vertices);
    if (push.removed.empty() && push.vertices.empty()) continue;
    to[r].put_all(push.removed);
    mesh_.pack(push.cells, push.vertices, to[r]);
  }
  const auto [came, n_touched, n_messages] = comm_.exchange(to, is_touched ? 1 : 0);
  const bool is_any_touched = n_touched + n_messages > 0;
  if (came.empty()) return {false, is_any_touched};
  std::unordered_set<std::uint64_t> done;  // removed by what was committed here
  if (!commits.empty())
    for (const Pending& one : pending_)
      for (CellHandle c : commits[one.winner].removed) done.insert(mesh_.number(c));
  DistributedMesh::Records records;
  for (const Comm::Message& message : came) {
    Unpacker in(message.bytes);
    for (std::uint64_t number : in.get_all<std::uint64_t>()) {
      if (!done.insert(number).second) continue;
      const CellHandle c = mesh_.cell_at(number);
      if (c.is_valid() && !mesh_.part().is_deleted(c)) mesh_.detach(c);
    }
    records.append(in);
  }
  mesh_.apply(records);
  return {true, is_any_touched};
}

RoundCounts PartRound::total(RoundCounts mine) {
  std::array<std::uint64_t, 3> sums = {mine.seeds, mine.candidates, mine.winners};
  comm_.sum(sums);
  mine.seeds = static_cast<std::size_t>(sums[0]);
  mine.candidates = static_cast<std::size_t>(sums[1]);
  mine.winners = static_cast<std::size_t>(sums[2]);
  mine.sub_rounds = sub_rounds_;
  return mine;
}

}  // namespace hfr::mpi
