// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MESH_MAPS_HH
#define HFR_REMESH_MESH_MAPS_HH

#include <array>
#include <vector>

#include "HalfFace/TetMesh.hh"

namespace hfr {

/// What became of vertices and cells in a run. "Old" handles are those of the mesh before it, "new" ones
/// those of the mesh after it.
struct MeshMaps {
  std::vector<VertexHandle> vertices;  ///< by old vertex: the new one, which may have moved; invalid: removed
  /// By old cell: the new one with the same four vertices; invalid where its place was filled otherwise.
  std::vector<CellHandle> cells;
  std::vector<VertexHandle> old_vertices;  ///< by new vertex: the old one; invalid: inserted
  std::vector<CellHandle> old_cells;  ///< by new cell: the old one with the same four vertices; invalid: none
  /// By new vertex: the old one whose properties it has. That is the vertex itself or, of an inserted one,
  /// the nearest vertex of the cells in which it was put, or what that one had its properties from.
  std::vector<VertexHandle> sources;
};

/// Makes the maps of a run. Internal to improve().
class MapRecorder {
 public:
  /// Before the run. Copies the vertices of the cells, 16 bytes a cell, and adds a property to the vertices.
  explicit MapRecorder(TetMesh& mesh);
  /// Takes the property away, if maps() has not.
  ~MapRecorder();
  MapRecorder(const MapRecorder&) = delete;
  MapRecorder& operator=(const MapRecorder&) = delete;

  /// After it. `order`: where vertices and cells went before the run; `garbage`: and after it. Empty lists:
  /// they stayed.
  MeshMaps maps(const GarbageMap& order, const GarbageMap& garbage);

 private:
  TetMesh& mesh_;
  std::size_t n_vertices_;
  std::vector<std::array<VertexHandle, 4>> cells_;
  VertexProperty<Index> source_;
};

}  // namespace hfr

#endif
