// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_TRANSFER_MESH_MAPS_HH
#define HFR_TRANSFER_MESH_MAPS_HH

#include <vector>

#include "hfremesh/HalfFace/Handles.hh"

namespace hfr {

/// What became of vertices and cells in a run. "Old" handles are those of the mesh before it, "new" ones
/// those of the mesh after it.
struct MeshMaps {
  std::vector<VertexHandle> vertices;  ///< by old vertex: the new one, which may have moved; invalid: removed
  /// By old cell: the new one with the same four vertices and the same properties; invalid where its place
  /// was filled otherwise.
  std::vector<CellHandle> cells;
  std::vector<VertexHandle> old_vertices;  ///< by new vertex: the old one; invalid: inserted
  /// By new cell: the old one with the same four vertices and the same properties; invalid: none.
  std::vector<CellHandle> old_cells;
  /// By new vertex: the old one whose properties it has. That is the vertex itself or, of an inserted one,
  /// the nearest vertex of the cells in which it was put, or what that one had its properties from.
  std::vector<VertexHandle> sources;
};

}  // namespace hfr

#endif
