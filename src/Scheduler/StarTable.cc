// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/StarTable.hh"

#include <algorithm>
#include <limits>
#include <numeric>

namespace hfr {
namespace {

constexpr std::uint32_t kNotListed = std::numeric_limits<std::uint32_t>::max();
constexpr double kWalkNanoseconds = 1'000;
constexpr std::size_t kWalksABlock = 32;

}  // namespace

StarTable::StarTable(const TetMesh& mesh, std::span<const VertexHandle> vertices,
                     std::span<const std::uint32_t> star_size, par::Policy policy)
    : begin_(vertices.size() + 1, 0) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    begin_[i] = sum;
    sum += star_size[vertices[i].idx()];
  }
  begin_.back() = sum;
  links_.resize(sum);
  // A few vertices walk their stars; many are cheaper to serve by one sweep over all cells.
  if (vertices.size() < mesh.n_vertices() / 16) {
    walk_stars(mesh, vertices, policy);
  } else {
    std::vector<std::uint32_t> all(vertices.size());
    std::iota(all.begin(), all.end(), 0U);
    sweep_cells(mesh, vertices, all, policy);
  }
}

void StarTable::walk_stars(const TetMesh& mesh, std::span<const VertexHandle> vertices, par::Policy policy) {
  // Left over: vertices of more cells than a Star holds, and those whose cells do not connect through faces.
  std::vector<std::uint8_t> is_left(vertices.size(), 0);
  par::for_each_dynamic(
      policy.for_items_of(kWalkNanoseconds), vertices.size(), kWalksABlock, [&](std::size_t i) {
        const std::size_t size = begin_[i + 1] - begin_[i];
        if (size == 0) return;
        Star star;
        if (!mesh.gather_star(vertices[i], star) || static_cast<std::size_t>(star.size) != size) {
          is_left[i] = 1;
          return;
        }
        const auto first = links_.begin() + static_cast<std::ptrdiff_t>(begin_[i]);
        for (std::size_t k = 0; k < size; ++k)
          links_[begin_[i] + k] = halfface_of(star.cells[k], star.corners[k]);
        std::sort(first, first + static_cast<std::ptrdiff_t>(size));
      });
  std::vector<std::uint32_t> left;
  for (std::size_t i = 0; i < is_left.size(); ++i)
    if (is_left[i]) left.push_back(static_cast<std::uint32_t>(i));
  if (!left.empty()) sweep_cells(mesh, vertices, left, policy);
}

void StarTable::sweep_cells(const TetMesh& mesh, std::span<const VertexHandle> vertices,
                            std::span<const std::uint32_t> numbers, par::Policy policy) {
  std::vector<std::uint32_t> number(mesh.n_vertices(), kNotListed);
  for (std::uint32_t i : numbers) number[vertices[i].idx()] = i;
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  par::for_targets(policy, mesh.n_cells(), numbers.size(), [&](std::size_t begin, std::size_t end) {
    if (begin == end) return;
    const Index first = vertices[numbers[begin]].idx(), last = vertices[numbers[end - 1]].idx();
    for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
      if (mesh.is_deleted(CellHandle(i))) continue;
      const Cell& cell = mesh.cell(CellHandle(i));
      for (int k = 0; k < 4; ++k) {
        const Index v = cell.v[static_cast<std::size_t>(k)].idx();
        if (v < first || v > last || number[v] == kNotListed) continue;
        links_[next[number[v]]++] = halfface_of(CellHandle(i), k);
      }
    }
  });
}

}  // namespace hfr
