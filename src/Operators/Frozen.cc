// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Operator.hh"

#include <array>

#include "HalfFace/CellOrder.hh"
#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"

namespace hfr {

std::vector<std::uint32_t> star_sizes(const TetMesh& mesh, par::Policy policy) {
  std::vector<std::uint32_t> size(mesh.n_vertices(), 0);
  par::for_targets(policy, mesh.n_cells(), size.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
      if (mesh.is_deleted(CellHandle(i))) continue;
      for (VertexHandle v : mesh.cell(CellHandle(i)).v)
        if (v.idx() >= begin && v.idx() < end) ++size[v.idx()];
    }
  });
  return size;
}

bool is_pinched(const TetMesh& mesh, VertexHandle v, std::uint32_t star_size, Star& scratch) {
  return !mesh.gather_star(v, scratch) || static_cast<std::uint32_t>(scratch.size) != star_size;
}

std::vector<std::uint8_t> pinched_vertices(const TetMesh& mesh, std::span<const std::uint32_t> star_size,
                                           par::Policy policy) {
  // The first of the cells that connect round a vertex has no neighbour there before it, and the last one
  // none behind it: a vertex with one such cell has all its cells in one piece, and needs no walk.
  enum End : std::uint8_t { kFirst = 1, kLast = 4 };  // and twice as much from the second on
  const CellOrder order(mesh, policy);
  std::vector<std::uint8_t> ends(mesh.n_vertices(), 0);
  const bool alone = par::thread_count(policy, mesh.n_cells()) == 1;
  const auto note = [&](VertexHandle v, End end) {
    std::uint8_t& of_vertex = ends[v.idx()];
    if (alone) {
      of_vertex = static_cast<std::uint8_t>(of_vertex | (of_vertex & end) << 1 | end);
      return;
    }
    const auto shared = par::atomic(of_vertex);
    par::before_shared_access();
    const std::uint8_t was = shared.fetch_or(end, std::memory_order_relaxed);
    par::before_shared_access();
    if ((was & end) != 0) shared.fetch_or(static_cast<std::uint8_t>(end << 1), std::memory_order_relaxed);
  };
  par::for_each(policy, mesh.n_cells(), [&](std::size_t i) {
    const CellHandle c(i);
    if (mesh.is_deleted(c)) return;
    const Cell& cell = mesh.cell(c);
    unsigned before = 0, behind = 0;  // by face: a bit where there is a neighbour
    for (unsigned k = 0; k < 4; ++k) {
      if (!cell.mate[k].is_valid()) continue;
      const bool is_before = order.less(cell_of(cell.mate[k]), c);
      before |= static_cast<unsigned>(is_before) << k;
      behind |= static_cast<unsigned>(!is_before) << k;
    }
    for (unsigned k = 0; k < 4; ++k) {
      const unsigned across_from_k = 1U << k;  // the one face that v[k] is not on
      if ((before & ~across_from_k) == 0) note(cell.v[k], kFirst);
      if ((behind & ~across_from_k) == 0) note(cell.v[k], kLast);
    }
  });
  std::vector<std::uint8_t> pinched(mesh.n_vertices(), 0);
  const bool any = par::reduce(
      policy, mesh.n_vertices(), false,
      [&](std::size_t i) {
        const bool is_one_piece = (ends[i] & 2 * kFirst) == 0 || (ends[i] & 2 * kLast) == 0;
        const bool asks = !is_one_piece || star_size[i] > Star::kCapacity;
        if (!asks) return false;
        Star star;
        pinched[i] = is_pinched(mesh, VertexHandle(i), star_size[i], star) ? 1 : 0;
        return pinched[i] != 0;
      },
      [](bool a, bool b) { return a || b; });
  if (!any) pinched.clear();
  return pinched;
}

std::vector<std::uint8_t> constrained_vertices(const TetMesh& mesh, par::Policy policy) {
  std::vector<std::uint8_t> frozen(mesh.n_vertices(), 0);
  par::for_each(policy, frozen.size(), [&](std::size_t i) {
    if (mesh.is_fixed(VertexHandle(i))) frozen[i] = 1;
  });
  const bool one_region = !mesh.has_regions();
  par::for_each(policy, mesh.n_cells(), [&](std::size_t i) {
    const CellHandle c(i);
    const auto& mate = mesh.cell(c).mate;
    if (one_region && mate[0].is_valid() && mate[1].is_valid() && mate[2].is_valid() && mate[3].is_valid())
      return;
    if (mesh.is_deleted(c)) return;
    for (int k = 0; k < 4; ++k) {
      const HalfFaceHandle h = halfface_of(c, k);
      const HalfFaceHandle m = mesh.opposite_halfface(h);
      if (m.is_valid() && (one_region || mesh.region(c) == mesh.region(cell_of(m)))) continue;
      for (VertexHandle v : mesh.halfface_vertices(h)) {  // shared by faces, which all write the same
        par::before_shared_access();
        par::atomic(frozen[v.idx()]).store(1, std::memory_order_relaxed);
      }
    }
  });
  for (const auto& face : mesh.labels().faces.entries())
    for (VertexHandle v : face.vertices) frozen[v.idx()] = 1;
  for (const auto& edge : mesh.labels().edges.entries())
    for (VertexHandle v : edge.vertices) frozen[v.idx()] = 1;
  for (const auto& face : mesh.locks().faces.entries())
    for (VertexHandle v : face.vertices) frozen[v.idx()] = 1;
  for (const auto& edge : mesh.locks().edges.entries())
    for (VertexHandle v : edge.vertices) frozen[v.idx()] = 1;
  return frozen;
}

std::vector<std::uint8_t> frozen_vertices(const TetMesh& mesh, par::Policy policy) {
  std::vector<std::uint8_t> frozen = constrained_vertices(mesh, policy);
  const std::vector<std::uint32_t> size = star_sizes(mesh, policy);
  par::for_ranges(policy, frozen.size(), [&](std::size_t begin, std::size_t end) {
    Star star;
    for (std::size_t i = begin; i < end; ++i) {
      if (!frozen[i] && size[i] > 0 && is_pinched(mesh, VertexHandle(i), size[i], star)) frozen[i] = 1;
    }
  });
  return frozen;
}

}  // namespace hfr
