// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_LAYERS_HH
#define HFR_HALFFACE_LAYERS_HH

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_set>
#include <utility>
#include <vector>

#include "HalfFace/TetMesh.hh"

/// What lies within so many layers of some items of a mesh. The cost is that of the items that are reached,
/// not of the mesh, but for vertices_within(), which answers for every vertex.
namespace hfr {

inline constexpr int kAllLayers = std::numeric_limits<int>::max();

/// Appends to `items` the items of so many layers round them, layer by layer, each in order of discovery.
/// around(rim, reach), with rim the items of one layer, calls reach(item) for what lies next to them, any
/// number of times; enter(item) is true when an item is taken in, which for each one it may be once.
template <class Item, class Around, class Enter>
void grow_layers(std::vector<Item>& items, int layers, Around&& around, Enter&& enter) {
  std::size_t first = 0;
  for (int layer = 0; layer < layers && first < items.size(); ++layer) {
    const std::vector<Item> rim(items.begin() + static_cast<std::ptrdiff_t>(first), items.end());
    first = items.size();
    around(std::span<const Item>(rim), [&](Item next) {
      if (enter(next)) items.push_back(next);
    });
  }
}

/// visit(c) for every cell that vertex_cells() shows of each of the vertices; a cell comes as often as it has
/// one of them.
template <class Visit>
void for_cells_round(const TetMesh& mesh, std::span<const VertexHandle> vertices, Visit&& visit) {
  Star star;
  for (VertexHandle v : vertices) {
    if (!mesh.gather_star(v, star))
      for (CellHandle c : mesh.vertex_cells(v)) visit(c);
    for (int i = 0; i < star.size; ++i) visit(star.cells[static_cast<std::size_t>(i)]);
  }
}

/// Flags of all vertices of a mesh: those of the cells and of so many layers of cells round them.
/// cells_round(vertices, visit) is for_cells_round() or does the same in another way.
template <class CellsRound>
std::vector<std::uint8_t> vertices_within(const TetMesh& mesh, std::span<const CellHandle> cells, int layers,
                                          CellsRound&& cells_round) {
  std::vector<std::uint8_t> within(mesh.n_vertices(), 0);
  std::vector<VertexHandle> vertices;
  const auto enter = [&](VertexHandle v) { return std::exchange(within[v.idx()], std::uint8_t{1}) == 0; };
  for (CellHandle c : cells)
    for (VertexHandle v : mesh.cell(c).v)
      if (enter(v)) vertices.push_back(v);
  const auto around = [&](std::span<const VertexHandle> rim, auto&& reach) {
    cells_round(rim, [&](CellHandle c) {
      for (VertexHandle v : mesh.cell(c).v) reach(v);
    });
  };
  grow_layers(vertices, layers, around, enter);
  return within;
}
inline std::vector<std::uint8_t> vertices_within(const TetMesh& mesh, std::span<const CellHandle> cells,
                                                 int layers) {
  return vertices_within(mesh, cells, layers, [&](std::span<const VertexHandle> rim, auto&& visit) {
    for_cells_round(mesh, rim, visit);
  });
}

/// The cells of the centre's region within so many layers of it, the centre first: those that share a vertex
/// with it, those that share one with them, and so on, in order of discovery. Vertices of more cells than a
/// Star holds lead no further.
inline std::vector<CellHandle> cells_within(const TetMesh& mesh, CellHandle centre, int layers) {
  std::vector<CellHandle> cells = {centre};
  std::unordered_set<Index> within = {centre.idx()};
  std::unordered_set<Index> asked;  // vertices
  Star star;
  const auto around = [&](std::span<const CellHandle> rim, auto&& reach) {
    for (CellHandle c : rim)
      for (VertexHandle v : mesh.cell(c).v) {
        if (!asked.insert(v.idx()).second || !mesh.gather_star(v, star)) continue;
        for (int i = 0; i < star.size; ++i) reach(star.cells[static_cast<std::size_t>(i)]);
      }
  };
  grow_layers(cells, layers, around, [&](CellHandle c) {
    return mesh.region(c) == mesh.region(centre) && within.insert(c.idx()).second;
  });
  return cells;
}

}  // namespace hfr

#endif
