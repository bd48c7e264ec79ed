// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MAP_RECORDER_HH
#define HFR_REMESH_MAP_RECORDER_HH

#include <array>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Result.hh"

namespace hfr {

/// Makes the maps of a run.
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
