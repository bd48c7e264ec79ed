// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_EDITS_HH
#define HFR_TRANSFER_EDITS_HH

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Transfer/MeshMaps.hh"

namespace hfr {

/// A vertex that is new or has moved, and where it lies in the mesh as it was: the value of a linear field
/// there is the sum of weights[k] times the value at vertex k of old_cell.
struct PlacedVertex {
  VertexHandle vertex;      ///< of the mesh as it is
  VertexHandle old_vertex;  ///< invalid: created
  Vec3 point;               ///< where it is
  CellHandle old_cell;      ///< of the mesh as it was; invalid where no cell with a volume is near
  /// They add up to 1. One below the -1e-10 that rounding leaves only where `inside` is false.
  std::array<double, 4> weights{};
  bool inside = true;  ///< false: it lies beyond the mesh as it was, and old_cell is the nearest
  /// From which old vertex on it was looked for: the vertex itself where it is old, otherwise that of the
  /// nearest of its neighbours that have one. Invalid: nothing old hangs together with it.
  VertexHandle near_vertex = {};
};

/// What a new cell has in common with an old one, as a share of the new one's volume. Negative for an old
/// cell that was inverted: the shares of a new cell add up to 1 where the old mesh covers it.
struct ParentCell {
  CellHandle old_cell;
  double share = 0;
};

struct CreatedCell {
  CellHandle cell;                       ///< of the mesh as it is
  std::array<VertexHandle, 4> vertices;  ///< likewise
};

/// The old cells that each created cell covers.
struct Parents {
  std::vector<std::size_t> first;  ///< n + 1 for n created cells
  std::vector<ParentCell> all;

  /// Those of entry i of created_cells, the largest share first; none where it lies beyond the mesh as it
  /// was.
  std::span<const ParentCell> of(std::size_t i) const {
    return {all.data() + first[i], all.data() + first[i + 1]};
  }
};

struct Overlaps;

/// What a repair did to a mesh, element by element: enough for a solver to bring its arrays, its matrix and
/// its own fields up to date. "Old" handles are those of the mesh before it, "new" ones those after it; both
/// run without gaps. All lists are in ascending order of the handles that they begin with.
class Edits {
 public:
  /// Cells are mapped where they have the same vertices in the same order.
  MeshMaps maps;
  std::vector<CellHandle> removed_cells;  ///< old
  std::vector<CreatedCell> created_cells;
  std::vector<CellHandle> moved_cells;         ///< new: mapped, and a vertex of theirs has moved
  std::vector<VertexHandle> removed_vertices;  ///< old
  std::vector<PlacedVertex> created_vertices;
  std::vector<PlacedVertex> moved_vertices;  ///< by the repair itself

  /// Found when they are first asked for, by intersecting cells: 2 to 4 microseconds for each created one.
  /// Until then these edits and their copies keep the mesh as it was; what they hold must not be changed. Any
  /// threads may ask. Throws InvalidInput where has_parents() is false.
  const Parents& parents() const;
  bool has_parents() const { return search_ != nullptr; }  ///< false: made without a mesh to keep

  bool empty() const {
    return removed_cells.empty() && created_cells.empty() && moved_vertices.empty() &&
           removed_vertices.empty() && created_vertices.empty();
  }

  /// The new array of a value per cell, of the old one: create(cell) gives those of created cells.
  template <class T, class Create>
  std::vector<T> cell_values(std::span<const T> old, Create&& create) const {
    std::vector<T> now(maps.old_cells.size());
    for (std::size_t i = 0; i < now.size(); ++i)
      if (maps.old_cells[i].is_valid()) now[i] = old[maps.old_cells[i].idx()];
    for (const CreatedCell& c : created_cells) now[c.cell.idx()] = create(c);
    return now;
  }
  /// The same for vertices: place(vertex) gives the values of those that are created or have moved.
  template <class T, class Place>
  std::vector<T> vertex_values(std::span<const T> old, Place&& place) const {
    std::vector<T> now(maps.old_vertices.size());
    for (std::size_t i = 0; i < now.size(); ++i)
      if (maps.old_vertices[i].is_valid()) now[i] = old[maps.old_vertices[i].idx()];
    for (const auto* list : {&created_vertices, &moved_vertices})
      for (const PlacedVertex& v : *list) now[v.vertex.idx()] = place(v);
    return now;
  }
  /// The new vertices of the cells, of the old ones.
  std::vector<std::array<VertexHandle, 4>> cell_vertices(
      std::span<const std::array<VertexHandle, 4>> old) const;
  /// The new points, of the old ones.
  std::vector<Vec3> points(std::span<const Vec3> old) const;

 private:
  struct ParentSearch;
  friend Edits make_edits(std::shared_ptr<const TetMesh>, const TetMesh&, MeshMaps, par::Policy);
  friend const Overlaps* overlaps_of_created(const Edits& edits);

  std::shared_ptr<ParentSearch> search_;
};

/// What became of `old` in `now`, without deleted things in either, by maps between the two; without parents.
Edits make_edits(const TetMesh& old, const TetMesh& now, MeshMaps maps, par::Policy policy);
/// The same with parents, for which `old` is kept.
Edits make_edits(std::shared_ptr<const TetMesh> old, const TetMesh& now, MeshMaps maps, par::Policy policy);

}  // namespace hfr

#endif
