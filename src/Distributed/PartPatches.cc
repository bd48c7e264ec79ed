// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartPatches.hh"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "Distributed/Buffer.hh"
#include "HalfFace/Writer.hh"
#include "Parallel/DisjointSets.hh"

namespace hfr::mpi {
namespace {

struct Told {
  std::uint64_t vertex = 0, patch = 0;
};

}  // namespace

/// Each rank joins what its cells join; then the owner of each vertex tells those near it the smallest number
/// that it knows of, until nobody learns of a smaller one.
PartPatches::PartPatches(const DistributedMesh& parts, std::span<const VertexHandle> vertices)
    : parts_(parts), patch_(parts.part().n_vertices(), kNoNumber) {
  const TetMesh& part = parts.part();
  Comm& comm = parts.comm();
  par::DisjointSets<Index> sets(part.n_vertices());
  std::vector<std::uint8_t> is_in(part.n_vertices(), 0);
  for (VertexHandle v : vertices) is_in[v.idx()] = 1;
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (part.is_deleted(c)) continue;
    const auto& v = part.cell(c).v;
    if (std::none_of(v.begin(), v.end(), [&](VertexHandle u) { return parts.is_own(u); })) continue;
    VertexHandle first;
    for (VertexHandle u : v) {
      if (!is_in[u.idx()]) continue;
      if (first.is_valid()) sets.join(first.idx(), u.idx());
      first = u;
    }
  }
  std::vector<std::uint64_t> least(part.n_vertices(), kNoNumber);  // by root
  for (VertexHandle v : vertices) {
    std::uint64_t& l = least[sets.find(v.idx())];
    l = std::min(l, parts.number(v));
  }
  std::vector<VertexHandle> border;  // own ones that others know of
  for (VertexHandle v : vertices)
    if (parts.is_own(v) && !parts.is_inside(v)) border.push_back(v);
  std::vector<std::uint64_t> said(border.size(), kNoNumber);
  for (bool is_done = false; !is_done;) {
    std::vector<Packer> to(comm.n_ranks());
    for (std::size_t i = 0; i < border.size(); ++i) {
      const std::uint64_t now = least[sets.find(border[i].idx())];
      if (now == said[i]) continue;
      said[i] = now;
      for_ranks(parts.near(border[i]), [&](int r) {
        if (r != comm.rank()) to[static_cast<std::size_t>(r)].put(Told{parts.number(border[i]), now});
      });
    }
    const Comm::Exchanged came = comm.exchange(to, 0);
    for (const Comm::Message& message : came.messages)
      for (Unpacker in(message.bytes); !in.at_end();) {
        const auto told = in.get<Told>();
        std::uint64_t& l = least[sets.find(parts.vertex_at(told.vertex).idx())];
        l = std::min(l, told.patch);
      }
    is_done = came.n_messages == 0;
  }
  for (VertexHandle v : vertices) patch_[v.idx()] = least[sets.find(v.idx())];
}

std::uint64_t PartPatches::of(CellHandle c) const {
  for (VertexHandle v : parts_.part().cell(c).v)
    if (of(v) != kNoNumber) return of(v);
  return kNoNumber;
}

std::vector<PatchChange> joined_on_first(Comm& comm, std::span<const PatchChange> mine) {
  std::vector<Packer> to(comm.n_ranks());
  if (!mine.empty()) to[0].put_all(mine);
  std::vector<PatchChange> all;
  for (const Comm::Message& message : comm.exchange(to)) {
    const auto theirs = Unpacker(message.bytes).get_all<PatchChange>();
    all.insert(all.end(), theirs.begin(), theirs.end());
  }
  std::ranges::sort(all, {}, [](const PatchChange& c) { return std::pair(c.patch, c.cell); });
  std::vector<PatchChange> joined;
  for (const PatchChange& one : all) {
    if (joined.empty() || joined.back().patch != one.patch) {
      joined.push_back(one);
      continue;
    }
    joined.back().was.join(one.was);
    joined.back().is.join(one.is);
  }
  return joined;
}

namespace {

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
  std::vector<VertexHandle> all(part.n_vertices());
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = VertexHandle(v);
  const PartPatches components(parts, all);
  std::map<std::uint64_t, Signs> by_component;
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    if (!is_own(c)) continue;
    Signs& signs = by_component[components.of(c)];
    signs.component = components.of(c);
    signs.negative += six_volume(c) < 0 ? 1 : 0;
    signs.positive += six_volume(c) > 0 ? 1 : 0;
  }
  std::vector<Signs> mine;
  for (const auto& [component, signs] : by_component) mine.push_back(signs);
  const Turns turns = decide_turns(comm, mine);
  // From cells of own vertices, of which a rank may have some without a cell of its own, to all that hang
  // together with them here, which are all that there are.
  std::vector<std::uint8_t> turns_over(part.n_cells(), 0);
  std::vector<CellHandle> found;
  std::uint64_t n_alone = 0;
  const auto reach = [&](CellHandle c) {
    if (std::exchange(turns_over[c.idx()], std::uint8_t{1}) == 0) found.push_back(c);
  };
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const CellHandle c(i);
    const auto& v = part.cell(c).v;
    if (part.is_deleted(c) ||
        std::none_of(v.begin(), v.end(), [&](VertexHandle u) { return parts.is_own(u); }))
      continue;
    const bool turned =
        std::binary_search(turns.components.begin(), turns.components.end(), components.of(c));
    if (turned) reach(c);
    n_alone += is_own(c) && turned != turns.whole ? 1 : 0;
  }
  for (std::size_t i = 0; i < found.size(); ++i)
    for (HalfFaceHandle m : part.cell(found[i]).mate)
      if (m.is_valid()) reach(cell_of(m));
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
