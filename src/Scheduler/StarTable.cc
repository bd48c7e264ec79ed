// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/StarTable.hh"

#include <algorithm>
#include <limits>
#include <numeric>

#include "Parallel/Atomic.hh"
#include "Parallel/Interleave.hh"

namespace hfr {
namespace {

constexpr std::uint32_t kNotListed = std::numeric_limits<std::uint32_t>::max();
constexpr int kTogetherThreads = 4;  // from which atomic counters and sorting pay
constexpr double kWalkNanoseconds = 1'000;

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
  const auto left = par::compact(policy.for_items_of(kWalkNanoseconds), vertices.size(), [&](std::size_t i) {
    const std::size_t size = begin_[i + 1] - begin_[i];
    if (size == 0) return false;
    Star star;
    if (!mesh.gather_star(vertices[i], star) || static_cast<std::size_t>(star.size) != size) return true;
    const auto first = links_.begin() + static_cast<std::ptrdiff_t>(begin_[i]);
    for (std::size_t k = 0; k < size; ++k)
      links_[begin_[i] + k] = halfface_of(star.cells[k], star.corners[k]);
    std::sort(first, first + static_cast<std::ptrdiff_t>(size));
    return false;
  });
  if (!left.empty()) sweep_cells(mesh, vertices, left, policy);
}

void StarTable::sweep_cells(const TetMesh& mesh, std::span<const VertexHandle> vertices,
                            std::span<const std::uint32_t> numbers, par::Policy policy) {
  std::vector<std::uint32_t> number(mesh.n_vertices(), kNotListed);
  for (std::uint32_t i : numbers) number[vertices[i].idx()] = i;
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  const bool together = par::thread_count(policy, mesh.n_cells()) >= kTogetherThreads;
  par::for_each(together ? policy : par::Policy{}, mesh.n_cells(), [&](std::size_t i) {
    const Cell& cell = mesh.cell(CellHandle(i));
    if (!cell.v[0].is_valid()) return;
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t at = number[cell.v[static_cast<std::size_t>(k)].idx()];
      if (at == kNotListed) continue;
      if (together) par::before_shared_access();
      const std::size_t place =
          together ? par::atomic(next[at]).fetch_add(1, std::memory_order_relaxed) : next[at]++;
      links_[place] = halfface_of(CellHandle(i), k);
    }
  });
  if (!together) return;  // in order already
  par::for_each(policy, numbers.size(), [&](std::size_t k) {
    const std::uint32_t i = numbers[k];
    std::sort(links_.begin() + static_cast<std::ptrdiff_t>(begin_[i]),
              links_.begin() + static_cast<std::ptrdiff_t>(begin_[i + 1]));
  });
}

}  // namespace hfr
