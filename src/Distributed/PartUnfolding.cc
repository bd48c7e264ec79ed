// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartUnfolding.hh"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "Distributed/Buffer.hh"
#include "Distributed/PartPatches.hh"
#include "Remesh/Strategy.hh"
#include "Remesh/Survey.hh"

namespace hfr::mpi {

double sum_in_order(Comm& comm, std::span<const Numbered> values, std::uint64_t n, std::uint64_t at_once) {
  const std::uint64_t n_values = comm.sum(values.size());
  const std::uint64_t n_turns = std::max<std::uint64_t>((n_values + at_once - 1) / at_once, 1);
  const std::uint64_t per_turn = n / n_turns + 1;
  std::vector<Numbered> mine(values.begin(), values.end());
  std::ranges::sort(mine, {}, &Numbered::number);
  double all = 0;
  auto at = mine.begin();
  for (std::uint64_t turn = 0; turn < n_turns; ++turn) {
    const auto end = std::ranges::lower_bound(at, mine.end(), (turn + 1) * per_turn, {}, &Numbered::number);
    std::vector<Packer> to(comm.n_ranks());
    if (at != end) to[0].put_all(std::span<const Numbered>(at, end));
    at = end;
    std::vector<Numbered> came;
    for (const Comm::Message& message : comm.exchange(to)) {
      const auto theirs = Unpacker(message.bytes).get_all<Numbered>();
      came.insert(came.end(), theirs.begin(), theirs.end());
    }
    std::ranges::sort(came, {}, &Numbered::number);
    for (const Numbered& one : came) all += one.value;
  }
  return comm.from_first(all);
}

std::size_t PartUnfolding::look() {
  invalid_ = invalid_cells(parts_.part(), policy_, known_values(parts_.work()));
  std::erase_if(invalid_, [&](CellHandle c) { return !parts_.is_own(c); });
  return static_cast<std::size_t>(parts_.comm().sum(invalid_.size()));
}

std::vector<VertexHandle> PartUnfolding::own_within(int layers, Spread::Stars kind) const {
  Spread spread(parts_, kind, 0);
  for (CellHandle c : invalid_) spread.begin(c, static_cast<std::uint32_t>(layers));
  spread.run();
  return std::move(spread.take_own().front());
}

std::size_t PartUnfolding::n_within(int layers) {
  return static_cast<std::size_t>(parts_.comm().sum(own_within(layers, Spread::Stars::kWalked).size()));
}

/// These and those that other ranks have within one edge of own ones, ascending.
std::vector<VertexHandle> PartUnfolding::with_others_near(std::span<const VertexHandle> own) const {
  Comm& comm = parts_.comm();
  std::vector<Packer> to(comm.n_ranks());
  for (VertexHandle v : own)
    for_ranks(parts_.near(v), [&](int r) {
      if (r != comm.rank()) to[static_cast<std::size_t>(r)].put(parts_.number(v));
    });
  std::vector<VertexHandle> all(own.begin(), own.end());
  for (const Comm::Message& message : comm.exchange(to))
    for (Unpacker in(message.bytes); !in.at_end();) all.push_back(parts_.vertex_at(in.get<std::uint64_t>()));
  std::sort(all.begin(), all.end());
  return all;
}

std::size_t PartUnfolding::take(int layers) {
  const TetMesh& part = parts_.part();
  std::vector<VertexHandle> own = own_within(layers, Spread::Stars::kWhole);
  std::erase_if(own, [&](VertexHandle v) { return parts_.work().frozen[v.idx()] != 0; });
  const std::uint64_t n = parts_.comm().sum(own.size());
  if (n == 0) return 0;
  parts_.work().forget_qualities();
  vertices_ = with_others_near(own);
  colours_.emplace(parts_, vertices_, policy_);
  groups_ = colours_->colour_groups();
  before_.clear();
  std::vector<std::uint8_t> is_taken(part.n_vertices(), 0);
  for (VertexHandle v : vertices_) {
    before_.push_back(part.point(v));
    is_taken[v.idx()] = 1;
  }
  cells_.clear();
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (part.is_deleted(c) || !parts_.is_own(c)) continue;
    const auto& v = part.cell(c).v;
    if (std::any_of(v.begin(), v.end(), [&](VertexHandle u) { return is_taken[u.idx()] != 0; }))
      cells_.push_back(c);
  }
  return static_cast<std::size_t>(n);
}

Tangle PartUnfolding::tangle() {
  std::vector<double> overlaps(cells_.size());
  par::for_each(policy_, cells_.size(),
                [&](std::size_t i) { overlaps[i] = overlap_of(parts_.part(), cells_[i]); });
  std::vector<Numbered> invalid;
  for (std::size_t i = 0; i < cells_.size(); ++i)
    if (overlaps[i] >= 0) invalid.push_back({parts_.number(cells_[i]), overlaps[i]});
  Tangle found;
  found.n_invalid = static_cast<std::size_t>(parts_.comm().sum(invalid.size()));
  found.overlap = sum_in_order(parts_.comm(), invalid, parts_.n_slots());
  return found;
}

/// Where they are now, to whoever holds them.
void PartUnfolding::tell(std::span<const VertexHandle> moved) {
  for (const PartSmoothing::Come& one : colours_->tell_points(moved))
    parts_.part().set_point(one.vertex, one.point);
}

double PartUnfolding::relax(double over) {
  TetMesh& part = parts_.part();
  std::vector<Numbered> ways;
  for (const auto& group : groups_) {
    const std::size_t first = ways.size();
    ways.resize(first + group.size());
    par::for_each(policy_, group.size(), [&](std::size_t k) {
      const VertexHandle v = group[k];
      const Vec3 step = relaxation(part, v, colours_->link(v), over);
      part.set_point(v, part.point(v) + step);
      ways[first + k] = {parts_.number(v), norm(step)};
    });
    tell(group);
  }
  return sum_in_order(parts_.comm(), ways, parts_.n_vertices());
}

/// Every rank has where the vertices were that it holds, its own or not.
void PartUnfolding::put_back() {
  for (std::size_t i = 0; i < vertices_.size(); ++i) parts_.part().set_point(vertices_[i], before_[i]);
}

void PartUnfolding::sweep() {
  TetMesh& part = parts_.part();
  for (const auto& group : groups_) {
    par::for_each(policy_.for_items_of(kUnfoldNanoseconds), group.size(), [&](std::size_t k) {
      const VertexHandle v = group[k];
      part.set_point(v, unfolded(part, v, colours_->link(v), effort_));
    });
    tell(group);
  }
}

std::size_t PartUnfolding::keep_what_helps() {
  TetMesh& part = parts_.part();
  const PartPatches patches(parts_, vertices_);
  std::vector<std::uint64_t> patch_of_cell;
  for (CellHandle c : cells_) patch_of_cell.push_back(patches.of(c));
  const std::vector<std::uint64_t> gain = patches_that_gain(patch_of_cell);
  std::uint64_t n_kept = 0;
  std::vector<VertexHandle> back;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const VertexHandle v = vertices_[i];
    if (!parts_.is_own(v) || colours_->link(v).empty()) continue;
    if (!std::binary_search(gain.begin(), gain.end(), patches.of(v))) {
      part.set_point(v, before_[i]);  // also where it has moved from 0 to -0, which compare equal
      back.push_back(v);
    } else if (part.point(v) != before_[i]) {
      ++n_kept;
    }
  }
  tell(back);
  return static_cast<std::size_t>(parts_.comm().sum(n_kept));
}

/// Ascending, the same on all ranks. Rank 0 is told of cells that are or were invalid, each with its number,
/// since their volumes are summed; of the others of a patch, the worst is enough.
std::vector<std::uint64_t> PartUnfolding::patches_that_gain(std::span<const std::uint64_t> patch_of_cell) {
  const TetMesh& part = parts_.part();
  std::map<std::uint64_t, PatchChange> valid;  // by patch
  std::vector<PatchChange> changes;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    std::array<Vec3, 4> now, old;
    const auto& v = part.cell(cells_[i]).v;
    for (std::size_t k = 0; k < 4; ++k) {
      now[k] = old[k] = part.point(v[k]);
      const auto at = std::lower_bound(vertices_.begin(), vertices_.end(), v[k]);
      if (at != vertices_.end() && *at == v[k])
        old[k] = before_[static_cast<std::size_t>(at - vertices_.begin())];
    }
    PatchChange change{patch_of_cell[i], parts_.number(cells_[i]), {}, {}};
    change.was.add(old[0], old[1], old[2], old[3]);
    change.is.add(now[0], now[1], now[2], now[3]);
    if (change.was.n_invalid() + change.is.n_invalid() > 0) {
      changes.push_back(change);
      continue;
    }
    PatchChange& all = valid[change.patch];
    all.patch = change.patch;
    all.was.join(change.was);
    all.is.join(change.is);
  }
  for (const auto& one : valid) changes.push_back(one.second);
  std::vector<std::uint64_t> gain;
  for (const PatchChange& one : joined_on_first(parts_.comm(), changes))
    if (helps(parts_.work(), one.was, one.is)) gain.push_back(one.patch);
  Packer said;
  said.put_all(gain);
  const std::vector<std::byte> bytes = told_by_first(parts_.comm(), said);
  return Unpacker(bytes).get_all<std::uint64_t>();
}

}  // namespace hfr::mpi
