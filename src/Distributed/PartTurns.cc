// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartTurns.hh"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>

#include "Distributed/Buffer.hh"
#include "HalfFace/Errors.hh"
#include "HalfFace/Writer.hh"
#include "Parallel/DisjointSets.hh"

namespace hfr::mpi {
namespace {

using Flags = std::vector<std::uint8_t>;  // by cell of a part; empty: none

bool has(const Flags& flags, CellHandle c) { return !flags.empty() && flags[c.idx()] != 0; }

/// What hangs together through faces goes by its cell with the smallest number, its first. Each rank joins
/// the cells that it holds; then the owner of each tells those that hold it of the first cell that it knows
/// of, until nobody learns of one with a smaller number. Of two cells that share a face the owner of either
/// holds both.
class Components {
 public:
  /// `turned`: of cells as they were read, after which the cells of each component that this part holds
  /// agree.
  Components(const DistributedMesh& parts, const Flags& turned)
      : parts_(parts), turned_(turned), sets_(parts.part().n_cells()), first_(parts.part().n_cells()) {
    join();
    for (bool is_done = false; !is_done;) is_done = !tell();
  }

  std::uint64_t of(CellHandle c) const { return first_[sets_.find(c.idx())].number; }
  /// Whether the cell, as it was read, is ordered against the first of its component.
  bool is_against(CellHandle c) const { return has(turned_, c) != first_[sets_.find(c.idx())].turned; }
  /// A way round through faces comes back to a cell the other way round.
  bool is_one_sided() const { return is_one_sided_; }

 private:
  struct First {
    std::uint64_t number = kNoNumber;
    bool turned = false;  // so that it agrees with the others of this part
  };
  struct Told {
    std::uint64_t cell = 0, first = 0;
    std::uint64_t is_against = 0;
  };

  void join() {
    const TetMesh& part = parts_.part();
    for (std::size_t i = 0; i < part.n_cells(); ++i) {
      const CellHandle c(i);
      if (part.is_deleted(c)) continue;
      for (HalfFaceHandle m : part.cell(c).mate)
        if (m.is_valid()) sets_.join(c.idx(), cell_of(m).idx());
      if (parts_.is_own(c) && parts_.is_in_zone(c)) border_.push_back(c);
    }
    for (std::size_t i = 0; i < part.n_cells(); ++i) {
      const CellHandle c(i);
      if (part.is_deleted(c)) continue;
      First& first = first_[sets_.find(c.idx())];
      if (parts_.number(c) < first.number) first = {parts_.number(c), has(turned_, c)};
    }
    said_.assign(border_.size(), kNoNumber);
  }

  /// Returns whether any rank has learnt of something.
  bool tell() {
    Comm& comm = parts_.comm();
    std::vector<Packer> to(comm.n_ranks());
    RankSet holders(parts_.within_two().words());
    for (std::size_t i = 0; i < border_.size(); ++i) {
      const CellHandle c = border_[i];
      if (std::exchange(said_[i], of(c)) == of(c)) continue;
      holders.clear();
      for (VertexHandle v : parts_.part().cell(c).v) holders.add(parts_.within_two(v));
      holders.remove(comm.rank());
      for_ranks(holders.bits(), [&](int r) {
        to[static_cast<std::size_t>(r)].put(Told{parts_.number(c), of(c), is_against(c) ? 1U : 0U});
      });
    }
    const Comm::Exchanged came = comm.exchange(to, 0);
    for (const Comm::Message& message : came.messages)
      for (Unpacker in(message.bytes); !in.at_end();) hear(in.get<Told>());
    return came.n_messages > 0;
  }
  void hear(const Told& told) {
    const CellHandle c = parts_.cell_at(told.cell);
    First& first = first_[sets_.find(c.idx())];
    const bool turned = has(turned_, c) != (told.is_against != 0);
    if (told.first < first.number) first = {told.first, turned};
    if (told.first == first.number && turned != first.turned) is_one_sided_ = true;
  }

  const DistributedMesh& parts_;
  const Flags& turned_;
  mutable par::DisjointSets<Index> sets_;
  std::vector<First> first_;         // by root
  std::vector<CellHandle> border_;   // own ones that others hold
  std::vector<std::uint64_t> said_;  // of each the first that others know of
  bool is_one_sided_ = false;
};

/// How many own cells of a component are of one kind, and of the other.
struct Sides {
  std::uint64_t component = 0;
  std::array<std::uint64_t, 2> n{};
};
/// side(c): 0 or 1; beyond that the cell does not count.
template <class Side>
std::vector<Sides> own_sides(const DistributedMesh& parts, const Components& components, Side&& side) {
  std::map<std::uint64_t, Sides> all;
  for (std::size_t i = 0; i < parts.part().n_cells(); ++i) {
    const CellHandle c(i);
    if (parts.part().is_deleted(c) || !parts.is_own(c)) continue;
    Sides& sides = all[components.of(c)];
    sides.component = components.of(c);
    if (const std::size_t s = side(c); s < 2) ++sides.n[s];
  }
  std::vector<Sides> mine;
  for (const auto& one : all) mine.push_back(one.second);
  return mine;
}
/// On rank 0 those of all ranks, by component; elsewhere none.
std::map<std::uint64_t, Sides> gathered(Comm& comm, std::span<const Sides> mine) {
  std::vector<Packer> to(comm.n_ranks());
  if (!mine.empty()) to[0].put_all(mine);
  std::map<std::uint64_t, Sides> all;
  for (const Comm::Message& message : comm.exchange(to))
    for (const Sides& one : Unpacker(message.bytes).get_all<Sides>())
      for (std::size_t s = 0; s < 2; ++s) all[one.component].n[s] += one.n[s];
  return all;
}

struct Decision {
  bool whole = false;                     ///< first everything, then those of these that are
  std::vector<std::uint64_t> components;  ///< ascending
  bool has(std::uint64_t component) const {
    return std::binary_search(components.begin(), components.end(), component);
  }
};
Decision told_by_first(Comm& comm, const Decision& decision) {
  Packer first;
  first.put(std::uint8_t{decision.whole});
  first.put_all(decision.components);
  const std::vector<std::byte> said = told_by_first(comm, first);
  Unpacker in(said);
  const bool is_whole = in.get<std::uint8_t>() != 0;
  return {is_whole, in.get_all<std::uint64_t>()};
}

/// Components most of whose cells are ordered against the first one.
Decision decide_order(Comm& comm, std::span<const Sides> mine) {
  Decision decision;
  for (const auto& [component, sides] : gathered(comm, mine))
    if (sides.n[1] > sides.n[0]) decision.components.push_back(component);
  return told_by_first(comm, decision);
}

/// Components of which all cells are turned, by how many are negative (1) and positive (0).
Decision decide_turns(Comm& comm, std::span<const Sides> mine) {
  const std::map<std::uint64_t, Sides> all = gathered(comm, mine);
  std::array<std::uint64_t, 2> n{};
  for (const auto& one : all)
    for (std::size_t s = 0; s < 2; ++s) n[s] += one.second.n[s];
  Decision decision;
  decision.whole = n[1] > n[0];
  for (const auto& [component, sides] : all) {
    const std::uint64_t negative = sides.n[decision.whole ? 0 : 1],
                        positive = sides.n[decision.whole ? 1 : 0];
    const bool alone = n[0] > 0 && n[1] > 0 && negative > positive;
    if (alone != decision.whole) decision.components.push_back(component);
  }
  return told_by_first(comm, decision);
}

/// Exchanges the last two vertices of these cells, and with each of all that hang together with it here.
void turn(TetMesh& part, const Flags& turns) {
  TetMesh::Writer writer(part);
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    if (part.is_deleted(CellHandle(i)) || turns[i] == 0) continue;
    Cell& cell = writer.cell(CellHandle(i));
    std::swap(cell.v[2], cell.v[3]);
    std::swap(cell.mate[2], cell.mate[3]);
    for (HalfFaceHandle& m : cell.mate)
      if (m.is_valid() && corner_of(m) >= 2) m = halfface_of(cell_of(m), 5 - corner_of(m));
  }
}

/// As MeshBuilder has it.
double six_volume(const TetMesh& part, CellHandle c) {
  const auto& v = part.cell(c).v;
  const Vec3 a = part.point(v[0]);
  return dot(part.point(v[1]) - a, cross(part.point(v[2]) - a, part.point(v[3]) - a));
}

}  // namespace

Turned orient(DistributedMesh& parts, Flags turned, Inverted inverted) {
  TetMesh& part = parts.part();
  Comm& comm = parts.comm();
  const auto count_own = [&](auto&& counts) {
    std::uint64_t n = 0;
    for (std::size_t i = 0; i < part.n_cells(); ++i) {
      const CellHandle c(i);
      n += !part.is_deleted(c) && parts.is_own(c) && counts(c) ? 1 : 0;
    }
    return comm.sum(n);
  };
  const bool conflict = comm.sum(std::count(turned.begin(), turned.end(), 1) > 0 ? 1 : 0) > 0;
  const auto has_none_to_turn = [&] {
    return inverted == Inverted::kLeave ||
           count_own([&](CellHandle c) { return six_volume(part, c) < 0; }) == 0;
  };
  if (!conflict && has_none_to_turn()) return {};
  const Components components(parts, turned);
  Flags now(part.n_cells(), 0), turns(part.n_cells(), 0);  // beside what was read; beside what is there
  if (conflict) {
    HFR_REQUIRE(comm.sum(components.is_one_sided() ? 1 : 0) == 0,
                "the mesh cannot be oriented (it closes on itself like a Moebius strip)");
    const Decision most = decide_order(comm, own_sides(parts, components, [&](CellHandle c) {
                                         return components.is_against(c) ? std::size_t{1} : std::size_t{0};
                                       }));
    for (std::size_t i = 0; i < part.n_cells(); ++i) {
      const CellHandle c(i);
      if (part.is_deleted(c)) continue;
      now[i] = components.is_against(c) != most.has(components.of(c)) ? 1 : 0;
      turns[i] = now[i] ^ (has(turned, c) ? 1 : 0);
    }
    turn(part, turns);
  }
  if (has_none_to_turn()) return {false, count_own([&](CellHandle c) { return now[c.idx()] != 0; })};
  const Decision negative =
      decide_turns(comm, own_sides(parts, components, [&](CellHandle c) {
                     const double volume = six_volume(part, c);
                     return volume > 0 ? std::size_t{0} : volume < 0 ? std::size_t{1} : std::size_t{2};
                   }));
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    turns[i] = !part.is_deleted(c) && negative.has(components.of(c)) ? 1 : 0;
    now[i] ^= turns[i];
  }
  turn(part, turns);
  return {negative.whole, count_own([&](CellHandle c) { return (now[c.idx()] != 0) != negative.whole; })};
}

}  // namespace hfr::mpi
