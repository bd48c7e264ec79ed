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
  // The first of the cells that connect round a vertex has no neighbour there before it: a vertex with one
  // such cell has all its cells in one piece, and needs no walk.
  const CellOrder order(mesh, policy);
  std::vector<std::uint8_t> n_first(mesh.n_vertices(), 0);
  const bool alone = par::thread_count(policy, mesh.n_cells()) == 1;
  const auto count = [&](VertexHandle v) {
    std::uint8_t& n = n_first[v.idx()];
    if (alone) {
      n = static_cast<std::uint8_t>(n < 2 ? n + 1 : 2);
      return;
    }
    const auto shared = par::atomic(n);  // 0 → 1 → 3: more than one
    const bool again = (shared.fetch_or(1, std::memory_order_relaxed) & 1) != 0;
    if (again) shared.fetch_or(2, std::memory_order_relaxed);
  };
  par::for_each(policy, mesh.n_cells(), [&](std::size_t i) {
    const CellHandle c(i);
    if (mesh.is_deleted(c)) return;
    const Cell& cell = mesh.cell(c);
    std::array<bool, 4> is_before{};
    for (std::size_t k = 0; k < 4; ++k)
      is_before[k] = cell.mate[k].is_valid() && order.less(cell_of(cell.mate[k]), c);
    for (std::size_t k = 0; k < 4; ++k)
      if (!is_before[(k + 1) % 4] && !is_before[(k + 2) % 4] && !is_before[(k + 3) % 4]) count(cell.v[k]);
  });
  std::vector<std::uint8_t> pinched(mesh.n_vertices(), 0);
  const bool any = par::reduce(
      policy, mesh.n_vertices(), false,
      [&](std::size_t i) {
        const bool asks = n_first[i] > 1 || star_size[i] > Star::kCapacity;
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
