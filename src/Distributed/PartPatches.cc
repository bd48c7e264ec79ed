// SPDX-License-Identifier: BSD-3-Clause
#include "Distributed/PartPatches.hh"

#include <algorithm>
#include <map>
#include <utility>

#include "Distributed/Buffer.hh"
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

}  // namespace hfr::mpi
