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

StarTable::StarTable(const TetMesh& mesh, std::span<const VertexHandle> vertices,
                     std::span<const std::uint32_t> star_size)
    : begin_(vertices.size() + 1, 0) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    begin_[i] = sum;
    const std::size_t size = star_size[vertices[i].idx()];
    if (size <= Star::kCapacity) sum += size;
  }
  begin_.back() = sum;
  links_.resize(sum);
  // A few vertices walk their stars; many are cheaper to serve by one sweep over all cells.
  if (vertices.size() < mesh.n_vertices() / 16)
    walk_stars(mesh, vertices);
  else
    sweep_cells(mesh, vertices);
}

void StarTable::walk_stars(const TetMesh& mesh, std::span<const VertexHandle> vertices) {
  Star star;
  std::vector<VertexHandle> in_parts;  // vertices whose cells do not connect through faces: rare
  std::vector<std::size_t> number;     // of those
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::size_t size = begin_[i + 1] - begin_[i];
    if (size == 0) continue;
    if (!mesh.gather_star(vertices[i], star) || static_cast<std::size_t>(star.size) != size) {
      in_parts.push_back(vertices[i]);
      number.push_back(i);
      continue;
    }
    const auto first = links_.begin() + static_cast<std::ptrdiff_t>(begin_[i]);
    for (std::size_t k = 0; k < size; ++k)
      links_[begin_[i] + k] = halfface_of(star.cells[k], star.corners[k]);
    std::sort(first, first + static_cast<std::ptrdiff_t>(size));
  }
  for (std::size_t n = 0; n < in_parts.size(); ++n) {
    std::size_t at = begin_[number[n]];
    for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
      const int corner = mesh.cell(CellHandle(c)).corner(in_parts[n]);
      if (corner < 4) links_[at++] = halfface_of(CellHandle(c), corner);
    }
  }
}

void StarTable::sweep_cells(const TetMesh& mesh, std::span<const VertexHandle> vertices) {
  const std::vector<std::uint32_t> number = numbers_of(mesh.n_vertices(), vertices);
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    const Cell& cell = mesh.cell(CellHandle(i));
    if (!cell.v[0].is_valid()) continue;
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t at = number[cell.v[static_cast<std::size_t>(k)].idx()];
      if (at != kNotListed && begin_[at + 1] != begin_[at])
        links_[next[at]++] = halfface_of(CellHandle(i), k);
    }
  }
}

std::vector<std::vector<std::uint32_t>> colour_vertices(const TetMesh& mesh,
                                                        std::span<const VertexHandle> vertices,
                                                        const StarTable& stars) {
  // By vertex of the mesh, so that a neighbour's colour is one read; a byte each stays in the cache.
  constexpr std::uint8_t kNone = 63;
  std::vector<std::uint8_t> colour(mesh.n_vertices(), kNone);
  std::vector<std::vector<std::uint32_t>> groups;
  std::vector<std::uint32_t> alone;  // what would need a 64th colour gets a group of its own
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    std::uint64_t used = 0;
    for (HalfFaceHandle h : stars.link(i)) {
      const auto& v = mesh.cell(cell_of(h)).v;
      used |= (std::uint64_t{1} << colour[v[0].idx()] | std::uint64_t{1} << colour[v[1].idx()]) |
              (std::uint64_t{1} << colour[v[2].idx()] | std::uint64_t{1} << colour[v[3].idx()]);
    }
    const int first = std::countr_one(used & ~(std::uint64_t{1} << kNone));
    if (first >= kNone) {
      alone.push_back(static_cast<std::uint32_t>(i));
      continue;
    }
    colour[vertices[i].idx()] = static_cast<std::uint8_t>(first);
    if (static_cast<std::size_t>(first) == groups.size()) groups.emplace_back();
    groups[static_cast<std::size_t>(first)].push_back(static_cast<std::uint32_t>(i));
  }
  for (std::uint32_t i : alone) groups.push_back({i});
  return groups;
}

}  // namespace hfr
