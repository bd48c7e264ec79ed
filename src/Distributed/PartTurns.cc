// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartTurns.hh"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "Distributed/Buffer.hh"
#include "HalfFace/Writer.hh"
#include "Parallel/DisjointSets.hh"

namespace hfr::mpi {
namespace {

/// The smallest number of a cell that hangs together with it through faces, for each cell of a part: each
/// rank joins the cells that it holds; then the owner of each tells those that hold it the smallest number
/// that it knows of, until nobody learns of a smaller one. Of two cells that share a face the owner of either
/// holds both.
std::vector<std::uint64_t> components_of(const DistributedMesh& parts) {
  const TetMesh& part = parts.part();
  Comm& comm = parts.comm();
  par::DisjointSets<Index> sets(part.n_cells());
  std::vector<std::uint64_t> least(part.n_cells(), kNoNumber);  // by root
  std::vector<CellHandle> border;                               // own ones that others hold
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (part.is_deleted(c)) continue;
    for (HalfFaceHandle m : part.cell(c).mate)
      if (m.is_valid()) sets.join(c.idx(), cell_of(m).idx());
    if (parts.is_own(c) && parts.is_in_zone(c)) border.push_back(c);
  }
  for (std::size_t i = 0; i < part.n_cells(); ++i)
    if (const CellHandle c(i); !part.is_deleted(c)) {
      std::uint64_t& l = least[sets.find(c.idx())];
      l = std::min(l, parts.number(c));
    }
  struct Told {
    std::uint64_t cell = 0, component = 0;
  };
  std::vector<std::uint64_t> said(border.size(), kNoNumber);
  RankSet holders(parts.within_two().words());
  for (bool is_done = false; !is_done;) {
    std::vector<Packer> to(comm.n_ranks());
    for (std::size_t i = 0; i < border.size(); ++i) {
      const std::uint64_t now = least[sets.find(border[i].idx())];
      if (now == said[i]) continue;
      said[i] = now;
      holders.clear();
      for (VertexHandle v : part.cell(border[i]).v) holders.add(parts.within_two(v));
      for_ranks(holders.bits(), [&](int r) {
        if (r != comm.rank()) to[static_cast<std::size_t>(r)].put(Told{parts.number(border[i]), now});
      });
    }
    const Comm::Exchanged came = comm.exchange(to, 0);
    for (const Comm::Message& message : came.messages)
      for (Unpacker in(message.bytes); !in.at_end();) {
        const auto told = in.get<Told>();
        const CellHandle c = parts.cell_at(told.cell);
        if (!c.is_valid()) continue;
        std::uint64_t& l = least[sets.find(c.idx())];
        l = std::min(l, told.component);
      }
    is_done = came.n_messages == 0;
  }
  std::vector<std::uint64_t> component(part.n_cells(), kNoNumber);
  for (std::size_t i = 0; i < part.n_cells(); ++i)
    if (!part.is_deleted(CellHandle(i))) component[i] = least[sets.find(static_cast<Index>(i))];
  return component;
}

struct Signs {
  std::uint64_t component = 0, negative = 0, positive = 0;
};

/// Components of which all cells are turned, ascending; on all ranks. `mine`: of this rank's own cells.
struct Turns {
  bool whole = false;  ///< first everything, then those of these that are
  std::vector<std::uint64_t> components;
};
Turns decide_turns(Comm& comm, std::span<const Signs> mine) {
  std::vector<Packer> to(comm.n_ranks());
  to[0].put_all(mine);
  std::map<std::uint64_t, Signs> all;
  Signs whole;
  for (const Comm::Message& message : comm.exchange(to))
    for (const Signs& one : Unpacker(message.bytes).get_all<Signs>())
      for (Signs* sum : {&all[one.component], &whole}) {
        sum->negative += one.negative;
        sum->positive += one.positive;
      }
  const bool flips = whole.negative > whole.positive;
  Packer first;
  first.put(std::uint8_t{flips});
  std::vector<std::uint64_t> turned;
  for (auto& [component, signs] : all) {
    if (flips) std::swap(signs.negative, signs.positive);
    const bool alone = whole.negative > 0 && whole.positive > 0 && signs.negative > signs.positive;
    if (alone != flips) turned.push_back(component);
  }
  first.put_all(turned);
  const std::vector<std::byte> said = told_by_first(comm, first);
  Unpacker in(said);
  const bool is_whole = in.get<std::uint8_t>() != 0;
  return {is_whole, in.get_all<std::uint64_t>()};
}

}  // namespace

Turned turn_negative_components(DistributedMesh& parts) {
  TetMesh& part = parts.part();
  Comm& comm = parts.comm();
  // As MeshBuilder has it.
  const auto six_volume = [&](CellHandle c) {
    const auto& v = part.cell(c).v;
    const Vec3 a = part.point(v[0]);
    return dot(part.point(v[1]) - a, cross(part.point(v[2]) - a, part.point(v[3]) - a));
  };
  const auto is_own = [&](CellHandle c) { return !part.is_deleted(c) && parts.is_own(c); };
  std::uint64_t n_negative = 0;
  for (std::size_t i = 0; i < part.n_cells(); ++i)
    n_negative += is_own(CellHandle(i)) && six_volume(CellHandle(i)) < 0 ? 1 : 0;
  if (comm.sum(n_negative) == 0) return {};
  const std::vector<std::uint64_t> component = components_of(parts);
  std::map<std::uint64_t, Signs> by_component;
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (!is_own(c)) continue;
    Signs& signs = by_component[component[i]];
    signs.component = component[i];
    signs.negative += six_volume(c) < 0 ? 1 : 0;
    signs.positive += six_volume(c) > 0 ? 1 : 0;
  }
  std::vector<Signs> mine;
  for (const auto& [which, signs] : by_component) mine.push_back(signs);
  const Turns turns = decide_turns(comm, mine);
  std::vector<CellHandle> found;
  std::uint64_t n_alone = 0;
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (part.is_deleted(c)) continue;
    const bool turned = std::binary_search(turns.components.begin(), turns.components.end(), component[i]);
    if (turned) found.push_back(c);
    n_alone += is_own(c) && turned != turns.whole ? 1 : 0;
  }
  TetMesh::Writer writer(part);
  for (CellHandle c : found) {
    Cell& cell = writer.cell(c);
    std::swap(cell.v[2], cell.v[3]);
    std::swap(cell.mate[2], cell.mate[3]);
    for (HalfFaceHandle& m : cell.mate)
      if (m.is_valid() && corner_of(m) >= 2) m = halfface_of(cell_of(m), 5 - corner_of(m));
  }
  return {turns.whole, comm.sum(n_alone)};
}

}  // namespace hfr::mpi
