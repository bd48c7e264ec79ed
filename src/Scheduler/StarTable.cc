// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/StarTable.hh"

#include <algorithm>
#include <bit>
#include <limits>

#include "Operators/Cavity.hh"

namespace hfr {
namespace {

constexpr std::uint32_t kNotListed = std::numeric_limits<std::uint32_t>::max();

std::vector<std::uint32_t> numbers_of(std::size_t n_vertices, std::span<const VertexHandle> vertices) {
  std::vector<std::uint32_t> number(n_vertices, kNotListed);
  for (std::size_t i = 0; i < vertices.size(); ++i) number[vertices[i].idx()] = static_cast<std::uint32_t>(i);
  return number;
}

}  // namespace

StarTable::StarTable(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy)
    : begin_(vertices.size() + 1, 0) {
  (void)policy;
  // A few vertices walk their stars; many are cheaper to serve by one sweep over all cells.
  if (vertices.size() < mesh.n_vertices() / 16) {
    Star star;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      begin_[i] = links_.size();
      mesh.gather_star(vertices[i], star);
      for (std::size_t k = 0; k < static_cast<std::size_t>(star.size); ++k)
        links_.push_back(halfface_of(star.cells[k], star.corners[k]));
      std::sort(links_.begin() + static_cast<std::ptrdiff_t>(begin_[i]), links_.end());
    }
    begin_.back() = links_.size();
    return;
  }
  const std::vector<std::uint32_t> number = numbers_of(mesh.n_vertices(), vertices);
  const auto for_corners = [&](auto&& visit) {
    for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
      const Cell& cell = mesh.cell(CellHandle(i));
      if (!cell.v[0].is_valid()) continue;
      for (int k = 0; k < 4; ++k) {
        const std::uint32_t at = number[cell.v[static_cast<std::size_t>(k)].idx()];
        if (at != kNotListed) visit(at, halfface_of(CellHandle(i), k));
      }
    }
  };
  for_corners([&](std::uint32_t at, HalfFaceHandle) { ++begin_[at]; });
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (begin_[i] > Star::kCapacity) begin_[i] = 0;
  std::size_t sum = 0;
  std::vector<std::size_t> next(vertices.size());
  std::vector<std::uint8_t> served(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    served[i] = begin_[i] > 0;
    const std::size_t count = begin_[i];
    begin_[i] = next[i] = sum;
    sum += count;
  }
  begin_.back() = sum;
  links_.resize(sum);
  for_corners([&](std::uint32_t at, HalfFaceHandle h) {
    if (served[at]) links_[next[at]++] = h;
  });
}

std::vector<std::vector<std::uint32_t>> colour_vertices(const TetMesh& mesh,
                                                        std::span<const VertexHandle> vertices,
                                                        const StarTable& stars) {
  const std::vector<std::uint32_t> number = numbers_of(mesh.n_vertices(), vertices);
  constexpr std::uint8_t kNone = 0xff;
  std::vector<std::uint8_t> colour(vertices.size(), kNone);
  std::vector<std::vector<std::uint32_t>> groups;
  std::vector<std::uint32_t> alone;  // what would need a 65th colour gets a group of its own
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    std::uint64_t used = 0;
    for (HalfFaceHandle h : stars.link(i)) {
      for (VertexHandle v : mesh.cell(cell_of(h)).v) {
        const std::uint32_t other = number[v.idx()];
        if (other != kNotListed && colour[other] != kNone) used |= std::uint64_t{1} << colour[other];
      }
    }
    const int first = std::countr_one(used);
    if (first >= 64) {
      alone.push_back(static_cast<std::uint32_t>(i));
      continue;
    }
    colour[i] = static_cast<std::uint8_t>(first);
    if (static_cast<std::size_t>(first) == groups.size()) groups.emplace_back();
    groups[static_cast<std::size_t>(first)].push_back(static_cast<std::uint32_t>(i));
  }
  for (std::uint32_t i : alone) groups.push_back({i});
  return groups;
}

}  // namespace hfr
