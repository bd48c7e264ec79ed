// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/EdgeList.hh"

#include <bit>

namespace hfr {

EdgeList::EdgeList(const TetMesh& mesh, par::Policy policy) {
  const int n_parts = par::thread_count(policy, mesh.n_cells());
  const auto begin_of = [&](int part) { return par::part_begin(mesh.n_cells(), n_parts, part); };
  std::vector<std::uint8_t> first(mesh.n_cells());
  std::vector<std::size_t> at(static_cast<std::size_t>(n_parts) + 1, 0);  // of each part's first edge
  par::parts(n_parts, [&](int part) {
    std::size_t n = 0;
    for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) {
      first[i] = static_cast<std::uint8_t>(mesh.first_edges(CellHandle(i)));
      n += static_cast<std::size_t>(std::popcount(first[i]));
    }
    at[static_cast<std::size_t>(part) + 1] = n;
  });
  for (std::size_t part = 1; part < at.size(); ++part) at[part] += at[part - 1];
  edges_.resize(at.back());
  vertices_.resize(at.back());
  par::parts(n_parts, [&](int part) {
    std::size_t n = at[static_cast<std::size_t>(part)];
    for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) {
      for (unsigned left = first[i]; left != 0; left &= left - 1, ++n) {
        edges_[n] = EdgeHandle(6 * i + static_cast<unsigned>(std::countr_zero(left)));
        vertices_[n] = mesh.edge_vertices(edges_[n]);
      }
    }
  });
}

}  // namespace hfr
