// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/CutoutRound.hh"

#include <algorithm>
#include <array>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "Distributed/Buffer.hh"
#include "Distributed/PartRound.hh"
#include "Distributed/Spread.hh"
#include "HalfFace/Errors.hh"
#include "HalfFace/Writer.hh"
#include "Scheduler/Select.hh"

namespace hfr::mpi {
namespace {

constexpr std::uint8_t kDeeper = 2;  // more layers round a cell from which an evaluation has come to the rim

/// What is told of a candidate; its cells and what it makes follow.
struct Announcement {
  std::uint64_t key = 0;
  SeedName name{};
  std::uint64_t seed_number = 0;
  std::uint32_t seed_place = 0, number = 0;
  std::uint32_t n_removed = 0, n_created = 0, n_removed_first = 0, n_created_first = 0;
  std::uint8_t removes_vertex = 0, adds_vertex = 0;
};

/// What a winner is told; its slots follow.
struct Award {
  std::uint32_t number = 0;
  std::uint64_t new_vertex = kNoNumber;
  std::uint64_t order = 0;  ///< among the winners of all ranks
};

}  // namespace

/// A candidate as rank 0 hears of it.
struct CutoutRound::Contender {
  Announcement told;
  int home = 0;
  std::vector<std::uint64_t> cells, made;
};

/// What it says to a winner.
struct CutoutRound::Prize {
  Award award;
  std::vector<std::uint64_t> fresh;
};

void change_slots(DistributedMesh& parts, const SlotChange& slots, std::span<const std::uint64_t> freed) {
  std::vector<std::uint64_t>& free = parts.free_slots();
  free.resize(free.size() - slots.n_taken);
  free.insert(free.end(), freed.begin(), freed.end());
  parts.n_slots() += slots.n_fresh;
  parts.add_numbers(slots.n_vertices);
}

bool NearChange::remove(const DistributedMesh& parts, std::span<const std::uint64_t> numbers) {
  const std::size_t n_before = gone.size();
  for (std::uint64_t number : numbers)
    if (const CellHandle held = parts.cell_at(number); held.is_valid() && !parts.part().is_deleted(held))
      gone.push_back(held);
  return gone.size() > n_before;
}

void write_home(DistributedMesh& parts, const NearChange& change) {
  for (CellHandle c : change.gone) parts.detach(c);
  if (!change.gone.empty()) parts.apply(change.come);
  for (std::uint64_t number : change.deleted)
    if (const VertexHandle v = parts.vertex_at(number); v.is_valid())
      TetMesh::Writer(parts.part()).mark_deleted(v);
  PartRound(parts).bring_near(!change.gone.empty(), {}, /*is_far=*/true);
}

void deepen(std::span<const std::uint64_t> cells, std::span<const std::uint64_t> met,
            std::span<std::uint8_t> depth) {
  for (std::uint64_t number : met) {
    const auto at = std::ranges::lower_bound(cells, number);
    if (at == cells.end() || *at != number)
      throw InternalError("what has come to the rim of a cutout did not grow for a cell of its middle");
    std::uint8_t& layers = depth[static_cast<std::size_t>(at - cells.begin())];
    if (layers + kDeeper > Spread::kDeepest) throw InternalError("a cutout of too many layers");
    layers += kDeeper;
  }
}

/// In rank order, a candidate wins when no cell of its scope is taken, it makes nothing twice, and the bounds
/// have room for it; slots as PartRound has them.
void CutoutRound::decide(std::vector<Contender>& all, std::size_t may_lose, std::size_t may_gain,
                         bool forbids_twice, std::vector<std::vector<Prize>>& prizes) {
  // Two seeds may have one name where both find the same: then the first in the order of numbers comes first,
  // as it does where all cells are in one mesh.
  std::sort(all.begin(), all.end(), [](const Contender& a, const Contender& b) {
    const auto order = [](const Announcement& t) {
      return std::tie(t.key, t.name, t.seed_number, t.seed_place);
    };
    return order(a.told) < order(b.told);
  });
  const std::span<const std::uint64_t> free = parts_.free_slots();
  std::vector<std::uint64_t> back;
  std::unordered_set<std::uint64_t> taken, made;
  std::uint64_t n_winners = 0;
  for (const Contender& one : all) {
    if (std::any_of(one.cells.begin(), one.cells.end(), [&](std::uint64_t c) { return taken.contains(c); }))
      continue;
    if (forbids_twice && !add_unless_there(one.made, made)) continue;
    taken.insert(one.cells.begin(), one.cells.end());
    const Announcement& told = one.told;
    const std::size_t n_same = std::min(told.n_removed, told.n_created);
    const std::size_t loss = told.removes_vertex != 0 ? told.n_removed - n_same : 0;
    const std::size_t gain = told.adds_vertex != 0 ? told.n_created - n_same : 0;
    if (loss > may_lose || gain > may_gain) {
      ++slots_.n_held_back;
      continue;
    }
    may_lose -= loss;
    may_gain -= gain;
    Prize prize;
    prize.award.number = one.told.number;
    prize.award.order = n_winners++;
    for (const CavityPart& p :
         parts_of(told.n_removed, told.n_created, told.n_removed_first, told.n_created_first)) {
      for (std::size_t k = p.n_removed; k < p.n_created; ++k)
        prize.fresh.push_back(slots_.n_taken < free.size() ? free[free.size() - ++slots_.n_taken]
                                                           : parts_.n_slots() + slots_.n_fresh++);
      for (std::size_t k = p.n_created; k < p.n_removed; ++k) back.push_back(one.cells[p.first_removed + k]);
    }
    if (one.told.adds_vertex != 0) prize.award.new_vertex = parts_.n_vertices() + slots_.n_vertices++;
    prizes[static_cast<std::size_t>(one.home)].push_back(std::move(prize));
  }
  freed_.assign(back.rbegin(), back.rend());
}

auto CutoutRound::select(const Candidates& candidates, std::size_t may_lose, std::size_t may_gain,
                         bool forbids_twice) -> Selected {
  Comm& comm = parts_.comm();
  const Comm::InPhase phase(comm, Phase::kSelect);
  const auto& has_met = cutout_.rim().has_met;
  for (std::size_t c = 0; c < has_met.size(); ++c)
    if (has_met[c] != 0) met_.push_back(cutout_.number(CellHandle(c)));
  if (candidates.size() > 0) met_.push_back(kNoNumber);  // the same call tells that there are any
  met_ = comm.all_gather(std::span<const std::uint64_t>(met_));
  has_candidates_ = std::erase(met_, kNoNumber) > 0;
  std::sort(met_.begin(), met_.end());
  Selected selected;
  if (!met_.empty() || !has_candidates_) return selected;
  std::vector<Packer> to(comm.n_ranks());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const PlanBase& plan = candidates.plan(i);
    const SeedAddress seed = candidates.seed(i);
    to[0].put(Announcement{candidates.key(i), candidates.name(i),
                           seed.cell.is_valid() ? cutout_.number(seed.cell) : kNoNumber, seed.place,
                           static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(plan.n_removed),
                           static_cast<std::uint32_t>(plan.n_created), plan.n_removed_first,
                           plan.n_created_first, plan.removes_vertex ? std::uint8_t{1} : std::uint8_t{0},
                           plan.adds_vertex ? std::uint8_t{1} : std::uint8_t{0}});
    std::vector<std::uint64_t> cells;
    for (CellHandle c : candidates.scope(i)) cells.push_back(cutout_.number(c));
    to[0].put_all(cells);
    to[0].put_all(candidates.made(i));
  }
  std::vector<Contender> all;
  for (const Comm::Message& message : comm.exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) {
      Contender& one = all.emplace_back();
      one.told = in.get<Announcement>();
      one.home = message.from;
      one.cells = in.get_all<std::uint64_t>();
      one.made = in.get_all<std::uint64_t>();
    }
  to.assign(comm.n_ranks(), {});
  Packer common;
  if (comm.rank() == 0) {
    std::vector<std::vector<Prize>> prizes(comm.n_ranks());
    decide(all, may_lose, may_gain, forbids_twice, prizes);
    for (std::size_t r = 0; r < prizes.size(); ++r)
      for (const Prize& prize : prizes[r]) {
        to[r].put(prize.award);
        to[r].put_all(prize.fresh);
      }
    common.put(slots_);
    common.put_all(freed_);
  }
  const std::vector<std::byte> said = told_by_first(comm, common);
  Unpacker in_said(said);
  slots_ = in_said.get<SlotChange>();
  freed_ = in_said.get_all<std::uint64_t>();
  selected.held_back = static_cast<std::size_t>(slots_.n_held_back);
  std::vector<std::uint64_t> new_vertices;
  for (const Comm::Message& message : comm.exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) {
      const auto award = in.get<Award>();
      Winner winner{award.number, candidates.seed(award.number), in.get_all<std::uint64_t>()};
      if (award.new_vertex != kNoNumber) new_vertices.push_back(award.new_vertex);
      selected.winners.push_back(std::move(winner));
      order_.push_back(award.order);
    }
  cutout_.number_new_vertices(std::move(new_vertices));
  return selected;
}

void CutoutRound::finish(std::span<const Commit> commits) {
  for (const Commit& commit : commits) {
    Change& change = changes_.emplace_back();
    for (CellHandle c : commit.removed) change.removed.push_back(cutout_.number(c));
    if (commit.removed_vertex.is_valid()) change.deleted.push_back(cutout_.number(commit.removed_vertex));
    std::vector<VertexHandle> vertices;
    for (CellHandle c : commit.created) {
      change.cells.push_back(cutout_.record(c));
      const auto& v = cutout_.mesh().cell(c).v;
      vertices.insert(vertices.end(), v.begin(), v.end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (VertexHandle v : vertices) change.vertices.push_back({cutout_.record(v), cutout_.star_before(v)});
    change.labels = cutout_.labels_of(commit.created, vertices);
    if (cutout_.is_new(vertices.back()))
      change.vertices.back().record.owner = change.vertices.front().record.owner;
  }
}

RoundCounts CutoutRound::total(RoundCounts mine) {
  std::array<std::uint64_t, 3> sums = {mine.seeds, mine.candidates, mine.winners};
  parts_.comm().sum(sums);
  mine.seeds = static_cast<std::size_t>(sums[0]);
  mine.candidates = static_cast<std::size_t>(sums[1]);
  mine.winners = static_cast<std::size_t>(sums[2]);
  return mine;
}

/// One record of each vertex, from those of the winners of several ranks: on each rank they count the cells
/// that its own winners have taken and made, and have the smallest of the made ones.
auto CutoutRound::merged(std::vector<Heard> all) -> std::vector<VertexRecord> {
  const auto order = [](const Heard& h) { return std::pair(h.touched.record.number, h.rank); };
  std::sort(all.begin(), all.end(), [&](const Heard& a, const Heard& b) { return order(a) < order(b); });
  all.erase(std::unique(all.begin(), all.end(),
                        [&](const Heard& a, const Heard& b) { return order(a) == order(b); }),
            all.end());
  std::vector<VertexRecord> records;
  for (const Heard& one : all) {
    const VertexRecord& r = one.touched.record;
    if (records.empty() || records.back().number != r.number) {
      records.push_back(r);
      continue;
    }
    VertexRecord& sum = records.back();
    sum.star_size += r.star_size - one.touched.star_before;  // of unsigned numbers, which go round
    sum.incident = std::min(sum.incident, r.incident);
  }
  return records;
}

void CutoutRound::bring_home() {
  if (!met_.empty()) return;
  ++parts_.work().clock;
  if (!has_candidates_) return;
  const Comm::InPhase phase(parts_.comm(), Phase::kBorder);
  Packer mine;
  for (const Change& change : changes_) {
    mine.put(parts_.comm().rank());
    mine.put_all(change.removed);
    mine.put_all(change.deleted);
    mine.put_all(change.vertices);
    mine.put_all(change.cells);
    mine.put_all(change.labels);
  }
  const std::vector<std::byte> said = parts_.comm().all_gather(std::span<const std::byte>(mine.bytes()));
  change_slots(parts_, slots_, freed_);
  std::vector<Heard> vertices;
  NearChange near;
  for (Unpacker in(said); !in.at_end();) {
    const auto rank = in.get<int>();
    const auto removed = in.get_all<std::uint64_t>();
    const auto deleted = in.get_all<std::uint64_t>();
    const auto v = in.get_all<Touched>();
    const auto c = in.get_all<DistributedMesh::CellRecord>();
    const auto l = in.get_all<LabelRecord>();
    if (!near.remove(parts_, removed)) continue;
    near.deleted.insert(near.deleted.end(), deleted.begin(), deleted.end());
    for (const Touched& one : v) vertices.push_back({one, rank});
    near.come.cells.insert(near.come.cells.end(), c.begin(), c.end());
    near.come.labels.insert(near.come.labels.end(), l.begin(), l.end());
  }
  near.come.vertices = merged(std::move(vertices));
  write_home(parts_, near);
}

}  // namespace hfr::mpi
