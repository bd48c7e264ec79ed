// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartInsertion.hh"

#include <algorithm>
#include <array>
#include <span>
#include <unordered_set>
#include <utility>

#include "Distributed/Buffer.hh"
#include "Distributed/CutoutRound.hh"
#include "Operators/VertexInsertion.hh"

namespace hfr::mpi {
namespace {

/// A cell below the goal, as rank 0 sees it.
struct Poor {
  double quality = 0;
  std::uint64_t number = 0;
  std::array<std::uint64_t, 4> v{};
};

struct Gathered {
  std::vector<Poor> poor;
  std::uint64_t n_listed = 0;  ///< by all ranks, also those that are not poor any more
};
/// The listed and the waiting cells that are still poor, on rank 0, in the order of numbers.
Gathered gather_poor(DistributedMesh& parts, double below, const Worklist& list,
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
  const auto n_own =
      std::ranges::count_if(list.cells(), [&](Index c) { return parts.is_own(CellHandle(c)); });
  std::vector<Packer> to(parts.comm().n_ranks());
  if (!poor.empty()) to[0].put_all(poor);
  poor.clear();
  const Comm::Exchanged came = parts.comm().exchange(to, static_cast<std::uint64_t>(n_own));
  for (const Comm::Message& message : came.messages) {
    const auto theirs = Unpacker(message.bytes).get_all<Poor>();
    poor.insert(poor.end(), theirs.begin(), theirs.end());
  }
  std::ranges::sort(poor, {}, &Poor::number);
  poor.erase(std::unique(poor.begin(), poor.end(),
                         [](const Poor& a, const Poor& b) { return a.number == b.number; }),
             poor.end());
  return {std::move(poor), came.sum};
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

template <class M>
RoundCounts insert(DistributedMesh& parts, const Ranks::Dig& dig, const Turns& turns, std::uint8_t depth,
                   const M& metric) {
  return round_on_cutout(parts, dig.look, turns.now, depth, [&](Cutout& cutout) {
    VertexInsertion<M> op{metric, cutout.work().quality, dig.gain};
    if (!dig.may_add_poor_cells) op.poor_below = dig.look.below;
    op.leaves_early = dig.leaves_early;
    op.rim = &cutout.rim();
    if (turns.now.size() + turns.waiting.size() > dig.many) {
      op.max_sites = static_cast<std::size_t>(dig.sites_of_many);
      op.least_promise = dig.promise_of_many;
    }
    return op;
  });
}

}  // namespace

RoundCounts insert_in_parts(DistributedMesh& parts, const Ranks::Dig& dig, const Worklist& list,
                            std::vector<std::uint64_t>& waiting, std::uint8_t depth) {
  Gathered gathered = gather_poor(parts, dig.look.below, list, waiting);
  if (gathered.n_listed == 0 && waiting.empty()) return {};
  const Turns turns = take_turns(parts.comm(), std::move(gathered.poor));
  waiting = turns.waiting;
  return with_metric(dig.look, [&](const auto& metric) { return insert(parts, dig, turns, depth, metric); });
}

}  // namespace hfr::mpi
