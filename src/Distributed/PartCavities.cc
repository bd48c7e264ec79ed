// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartCavities.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "Distributed/AskOwners.hh"
#include "Distributed/Buffer.hh"
#include "HalfFace/Geometry.hh"
#include "Parallel/DisjointSets.hh"

namespace hfr::mpi {
namespace {

/// A set of cells that a rank has found to hang together; a part has fewer than 2^32 changed ones.
std::uint64_t name_of_set(int rank, Index set) {
  return (static_cast<std::uint64_t>(rank) << 32U) | static_cast<std::uint32_t>(set);
}

/// That a set of this rank hangs together with a cell of another one.
struct Tie {
  Index mine = 0;
  std::uint64_t number = 0;  ///< of the cell
  std::int64_t owner = 0;
};

/// For each name in these pairs the smallest one that it is tied to.
std::map<std::uint64_t, std::uint64_t> least_names(const std::vector<std::array<std::uint64_t, 2>>& pairs) {
  std::vector<std::uint64_t> all;
  for (const auto& pair : pairs) all.insert(all.end(), pair.begin(), pair.end());
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  const auto place = [&](std::uint64_t name) {
    return static_cast<Index>(std::ranges::lower_bound(all, name) - all.begin());
  };
  par::DisjointSets<Index> sets(all.size());
  for (const auto& pair : pairs) sets.join(place(pair[0]), place(pair[1]));
  std::map<std::uint64_t, std::uint64_t> least;
  for (std::size_t i = 0; i < all.size(); ++i) least[all[i]] = all[sets.find(static_cast<Index>(i))];
  return least;
}

}  // namespace

/// Sets within this rank first, as hfr::Cavities has them; then those that other ranks' cells join.
PartCavities::PartCavities(Comm& comm, const OldRegion& region, std::vector<CellHandle> old_cells,
                           std::vector<CellHandle> new_cells, std::span<const std::uint64_t> new_numbers,
                           Overlaps overlaps, std::vector<double> new_volume, std::vector<CellHandle> beside,
                           std::span<const NewNeighbour> neighbours)
    : comm_(comm) {
  const std::size_t n_old = old_cells.size(), n_new = new_cells.size();
  const auto is_mine = [&](CellHandle c) { return region.owner(c) == comm.rank(); };
  const auto old_place = [&](CellHandle c) -> std::size_t {
    const auto at = std::ranges::lower_bound(old_cells, c);
    return at != old_cells.end() && *at == c ? static_cast<std::size_t>(at - old_cells.begin()) : n_old;
  };
  const auto new_place = [&](std::uint64_t number) -> std::size_t {
    const auto at = std::ranges::lower_bound(new_numbers, number);
    return at != new_numbers.end() && *at == number ? static_cast<std::size_t>(at - new_numbers.begin())
                                                    : n_new;
  };
  par::DisjointSets<Index> sets(n_old + n_new);  // those of other ranks stay by themselves
  std::vector<Tie> to_old, to_new;
  const auto place_of_mine = [&](std::uint64_t number) {  // n_old where it has not changed
    const CellHandle c = region.cell_at(number);
    return c.is_valid() ? old_place(c) : n_old;
  };
  const auto tie_to_old = [&](std::size_t mine, std::uint64_t number, int owner) {
    if (owner != comm.rank())
      to_old.push_back({static_cast<Index>(mine), number, owner});
    else if (const std::size_t j = place_of_mine(number); j < n_old)
      sets.join(static_cast<Index>(mine), static_cast<Index>(j));
  };
  region.for_faces_of_own_changed([&](std::uint64_t cell, std::uint64_t behind, int owner) {
    tie_to_old(place_of_mine(cell), behind, owner);
  });
  for (std::size_t i = 0; i < n_new; ++i)
    for (const Overlap& part : overlaps.of(i))
      tie_to_old(n_old + i, region.number(part.old_cell), region.owner(part.old_cell));
  for (const NewNeighbour& one : neighbours) {
    const auto mine = static_cast<Index>(n_old + one.cell);
    if (one.owner != comm.rank())
      to_new.push_back({mine, one.number, one.owner});
    else if (const std::size_t i = new_place(one.number); i < n_new)
      sets.join(mine, static_cast<Index>(n_old + i));
  }
  const auto name_of = [&](std::size_t i) {
    return name_of_set(comm.rank(), sets.find(static_cast<Index>(i)));
  };
  std::vector<std::array<std::uint64_t, 2>> pairs;
  const auto add_pairs = [&](const std::vector<Tie>& ties, auto&& place, std::size_t n_places,
                             std::size_t first) {
    const auto append_name = [&](std::uint64_t number, std::vector<std::uint64_t>& names) {
      const std::size_t i = place(number);
      names.push_back(i < n_places ? name_of(first + i) : kNoNumber);
    };
    const auto names = ask_owners<std::uint64_t>(comm, ties, 1, append_name);
    for (std::size_t t = 0; t < ties.size(); ++t)
      if (names[t] != kNoNumber) pairs.push_back({name_of(ties[t].mine), names[t]});
  };
  add_pairs(to_old, place_of_mine, n_old, 0);
  add_pairs(to_new, new_place, n_new, n_old);
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  pairs = comm.all_gather(std::span<const std::array<std::uint64_t, 2>>(pairs));
  const std::map<std::uint64_t, std::uint64_t> least = least_names(pairs);

  // By name: sets of this rank that join elsewhere are one cavity.
  std::map<std::uint64_t, std::size_t> place_of_name;
  std::vector<Cavities::Cavity> cavities;
  const auto cavity_of = [&](std::size_t i) -> Cavities::Cavity& {
    std::uint64_t name = name_of(i);
    const auto joined = least.find(name);
    const bool is_shared = joined != least.end();
    if (is_shared) name = joined->second;
    const auto [at, is_new] = place_of_name.emplace(name, cavities.size());
    if (is_new) {
      cavities.emplace_back();
      is_counted_.push_back(name >> 32U == static_cast<std::uint64_t>(comm.rank()) ? 1 : 0);
      if (is_shared) shared_.push_back({name, at->second});
    }
    return cavities[at->second];
  };
  for (std::size_t j = 0; j < n_old; ++j)
    if (is_mine(old_cells[j])) cavity_of(j).old_cells.push_back(static_cast<Index>(j));
  for (std::size_t i = 0; i < n_new; ++i) cavity_of(n_old + i).new_cells.push_back(static_cast<Index>(i));
  std::ranges::sort(shared_, {}, &Shared::name);
  std::vector<double> old_volume;
  old_volume.reserve(n_old);
  for (CellHandle c : old_cells) old_volume.push_back(volume(region.mesh(), c));
  cavities_.emplace(std::move(old_cells), std::move(new_cells), std::move(overlaps), std::move(old_volume),
                    std::move(new_volume), std::move(beside), std::move(cavities));
}

/// On the rank whose name it is.
template <class T>
void PartCavities::join_all(std::span<T> mine) {
  struct Said {
    std::uint64_t name = 0;
    T value{};
  };
  const auto home = [](std::uint64_t name) { return static_cast<std::size_t>(name >> 32U); };
  std::vector<Packer> to(comm_.n_ranks()), back(comm_.n_ranks());
  for (const Shared& one : shared_) to[home(one.name)].put(Said{one.name, mine[one.cavity]});
  const auto came = comm_.exchange(to);
  std::map<std::uint64_t, T> all;
  for (const Comm::Message& message : came)
    for (Unpacker in(message.bytes); !in.at_end();) {
      const auto said = in.get<Said>();
      const auto [at, is_new] = all.emplace(said.name, said.value);
      if (!is_new) at->second.add(said.value);
    }
  for (const Comm::Message& message : came)
    for (Unpacker in(message.bytes); !in.at_end();)
      back[static_cast<std::size_t>(message.from)].put(all.at(in.get<Said>().name));
  std::vector<std::vector<T>> joined(comm_.n_ranks());
  for (const Comm::Message& message : comm_.exchange(back))
    for (Unpacker in(message.bytes); !in.at_end();)
      joined[static_cast<std::size_t>(message.from)].push_back(in.get<T>());
  std::vector<std::size_t> next(comm_.n_ranks(), 0);
  for (const Shared& one : shared_) mine[one.cavity] = joined[home(one.name)][next[home(one.name)]++];
}

void PartCavities::join(std::span<CavityBounds> bounds) { join_all(bounds); }
void PartCavities::join(std::span<FixedSum> sums) { join_all(sums); }

double PartCavities::total(std::span<const double> by_cavity) {
  double largest = 0;
  for (std::size_t i = 0; i < by_cavity.size(); ++i)
    if (is_counted_[i] != 0) largest = std::max(largest, std::abs(by_cavity[i]));
  FixedSum mine = sum_of_up_to(-comm_.min(-largest)), all = mine;
  for (std::size_t i = 0; i < by_cavity.size(); ++i)
    if (is_counted_[i] != 0) mine.add(by_cavity[i]);
  for (const FixedSum& sum : comm_.all_gather(std::span<const FixedSum>(&mine, 1))) all.add(sum);
  return all.value();
}

}  // namespace hfr::mpi
