// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/PinchedStars.hh"

#include <algorithm>

namespace hfr {

PinchedStars::PinchedStars(const TetMesh& mesh, std::span<const std::uint8_t> pinched, par::Policy policy) {
  if (pinched.empty()) return;
  const auto vertex = [&](Index corner) { return mesh.cell(CellHandle(corner / 4)).v[corner % 4]; };
  std::vector<Index> corners = par::compact<Index>(policy, 4 * mesh.n_cells(), [&](std::size_t i) {
    const VertexHandle v = vertex(static_cast<Index>(i));
    return v.is_valid() && pinched[v.idx()] != 0;
  });
  std::stable_sort(corners.begin(), corners.end(), [&](Index a, Index b) { return vertex(a) < vertex(b); });
  for (Index corner : corners) {
    if (vertices_.empty() || vertices_.back() != vertex(corner)) {
      vertices_.push_back(vertex(corner));
      begin_.push_back(cells_.size());
    }
    cells_.push_back(CellHandle(corner / 4));
  }
  begin_.push_back(cells_.size());
}

std::span<const CellHandle> PinchedStars::cells(VertexHandle v) const {
  const auto at = std::lower_bound(vertices_.begin(), vertices_.end(), v);
  if (at == vertices_.end() || *at != v) return {};
  const auto i = static_cast<std::size_t>(at - vertices_.begin());
  return {cells_.data() + begin_[i], begin_[i + 1] - begin_[i]};
}

}  // namespace hfr
