// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Stars.hh"

#include <cstdint>
#include <numeric>

namespace hfr {

Stars::Stars(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy) {
  Index n = 0;
  std::vector<std::uint8_t> is_asked_for;  // in fewer bytes than numbers: all cells are looked at
  for (VertexHandle v : vertices) {
    if (!v.is_valid()) continue;
    if (number_.empty()) {
      number_.assign(mesh.n_vertices(), kNone);
      is_asked_for.assign(mesh.n_vertices(), 0);
    }
    is_asked_for[v.idx()] = 1;
    if (number_[v.idx()] == kNone) number_[v.idx()] = n++;
  }
  if (n == 0) return;
  const std::vector<Index> round = par::compact<Index>(policy, mesh.n_cells(), [&](std::size_t i) {
    if (mesh.is_deleted(CellHandle(i))) return false;
    const auto& v = mesh.cell(CellHandle(i)).v;
    return (is_asked_for[v[0].idx()] | is_asked_for[v[1].idx()] | is_asked_for[v[2].idx()] |
            is_asked_for[v[3].idx()]) != 0;
  });
  first_.assign(std::size_t{n} + 1, 0);
  const auto for_each = [&](auto&& visit) {
    for (const Index i : round)
      for (VertexHandle v : mesh.cell(CellHandle(i)).v)
        if (number_[v.idx()] != kNone) visit(number_[v.idx()], CellHandle(i));
  };
  for_each([&](Index vertex, CellHandle) { ++first_[vertex + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  cells_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for_each([&](Index vertex, CellHandle c) { cells_[next[vertex]++] = c; });
}

}  // namespace hfr
