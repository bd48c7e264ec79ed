// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/CutoutRound.hh"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "Distributed/PartRound.hh"
#include "Scheduler/Select.hh"

namespace hfr::mpi {
namespace {

constexpr std::uint8_t kDeeper = 2;  // more layers round a cell from which an evaluation has come to the rim

}  // namespace

/// In rank order, a candidate wins when no cell of its scope is taken, and it makes nothing twice.
std::vector<std::size_t> CutoutRound::independent(std::span<const Candidate> candidates,
                                                  bool check_links) const {
  std::vector<std::uint8_t> is_taken(cutout_.mesh().n_cells(), 0);
  std::unordered_set<std::uint64_t> made;
  std::vector<std::size_t> won;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto scope = candidates[i].scope;
    if (std::any_of(scope.begin(), scope.end(), [&](CellHandle c) { return is_taken[c.idx()] != 0; }))
      continue;
    if (check_links && !add_unless_there(candidates[i].made, made)) continue;
    for (CellHandle c : scope) is_taken[c.idx()] = 1;
    won.push_back(i);
  }
  return won;
}

/// Nothing where an evaluation has come to the rim. Else the independent ones for which the bounds have room;
/// slots as PartRound has them.
auto CutoutRound::select(std::span<const Candidate> candidates, std::size_t may_lose, std::size_t may_gain,
                         bool check_links) -> Selected {
  const auto& met = cutout_.rim().has_met;
  for (std::size_t c = 0; c < met.size(); ++c)
    if (met[c] != 0) met_.push_back(cutout_.number(CellHandle(c)));
  Selected selected;
  if (!met_.empty()) return selected;
  const std::span<const std::uint64_t> free = parts_.free_slots();
  std::vector<std::uint64_t> back;
  for (std::size_t i : independent(candidates, check_links)) {
    const PlanBase& plan = *candidates[i].plan;
    const std::size_t n_same = std::min(plan.n_removed, plan.n_created);
    const std::size_t loss = plan.removes_vertex ? plan.n_removed - n_same : 0;
    const std::size_t gain = plan.adds_vertex ? plan.n_created - n_same : 0;
    if (loss > may_lose || gain > may_gain) {
      ++selected.held_back;
      continue;
    }
    may_lose -= loss;
    may_gain -= gain;
    Winner winner{i, candidates[i].seed, {}};
    for (std::size_t k = n_same; k < plan.n_created; ++k)
      winner.fresh.push_back(slots_.n_taken < free.size() ? free[free.size() - ++slots_.n_taken]
                                                          : parts_.n_slots() + slots_.n_fresh++);
    for (std::size_t k = n_same; k < plan.n_removed; ++k)
      back.push_back(cutout_.number(candidates[i].scope[k]));
    if (plan.adds_vertex) ++slots_.n_vertices;
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
    if (cutout_.is_new(vertices.back())) change.vertices.back().owner = change.vertices.front().owner;
  }
}

Packer CutoutRound::said(const RoundCounts& counts) const {
  Packer said;
  said.put_all(met_);
  if (!met_.empty()) return said;
  said.put(counts);
  said.put(slots_);
  said.put_all(freed_);
  said.put(static_cast<std::uint64_t>(changes_.size()));
  for (const Change& change : changes_) {
    said.put_all(change.removed);
    said.put_all(change.vertices);
    said.put_all(change.cells);
    said.put_all(change.labels);
  }
  return said;
}

std::optional<RoundCounts> follow(DistributedMesh& parts, std::span<const std::byte> said,
                                  std::span<const std::uint64_t> cells, std::span<std::uint8_t> depth) {
  Unpacker in(said);
  const auto met = in.get_all<std::uint64_t>();
  for (std::uint64_t number : met)
    depth[static_cast<std::size_t>(std::ranges::lower_bound(cells, number) - cells.begin())] += kDeeper;
  if (!met.empty()) return std::nullopt;
  const auto counts = in.get<RoundCounts>();
  const auto slots = in.get<CutoutRound::SlotChange>();
  const auto freed = in.get_all<std::uint64_t>();
  std::vector<std::uint64_t>& free = parts.free_slots();
  free.resize(free.size() - slots.n_taken);
  free.insert(free.end(), freed.begin(), freed.end());
  parts.n_slots() += slots.n_fresh;
  parts.add_numbers(slots.n_vertices);
  ++parts.work().clock;
  std::vector<DistributedMesh::VertexRecord> vertices;
  std::vector<DistributedMesh::CellRecord> created;
  std::vector<LabelRecord> labels;
  std::vector<CellHandle> gone;
  for (auto n = in.get<std::uint64_t>(); n > 0; --n) {
    const auto removed = in.get_all<std::uint64_t>();
    const auto v = in.get_all<DistributedMesh::VertexRecord>();
    const auto c = in.get_all<DistributedMesh::CellRecord>();
    const auto l = in.get_all<LabelRecord>();
    // Whose vertices have one of the new cells holds one of those that they stand for.
    const std::size_t n_before = gone.size();
    for (std::uint64_t number : removed)
      if (const CellHandle held = parts.cell_at(number); held.is_valid() && !parts.part().is_deleted(held))
        gone.push_back(held);
    if (gone.size() == n_before) continue;
    vertices.insert(vertices.end(), v.begin(), v.end());
    created.insert(created.end(), c.begin(), c.end());
    labels.insert(labels.end(), l.begin(), l.end());
  }
  for (CellHandle c : gone) parts.detach(c);
  if (!gone.empty()) parts.apply(vertices, created, labels);
  PartRound(parts).bring_near(!gone.empty(), {}, /*is_far=*/true);
  return counts;
}

}  // namespace hfr::mpi
