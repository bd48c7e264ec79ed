// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_MAP_RECORDER_HH
#define HFR_REMESH_MAP_RECORDER_HH

#include <array>
#include <optional>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Remesh/Result.hh"

namespace hfr {

/// Makes the maps of a run.
class MapRecorder {
 public:
  /// Before the run. Adds a property to the vertices, and one to cells that have others. `before`: a copy of
  /// the mesh that outlives this object; without one the vertices of the cells are copied, 16 bytes a cell.
  explicit MapRecorder(TetMesh& mesh, const TetMesh* before = nullptr);
  /// Takes them away.
  ~MapRecorder();
  MapRecorder(const MapRecorder&) = delete;
  MapRecorder& operator=(const MapRecorder&) = delete;

  /// After it. `order`: where vertices and cells went before the run; `garbage`: and after it. Empty lists:
  /// they stayed.
  ///
  /// A cell may go and come again in its old place, with the properties of another that was there in between.
  /// With a copy of the mesh it has its own ones again, if all have names; otherwise it counts as another
  /// cell.
  MeshMaps maps(const GarbageMap& order, const GarbageMap& garbage, par::Policy policy = {});

 private:
  void restore(CellHandle old, CellHandle now);
  const std::array<VertexHandle, 4>& old_cell(std::size_t i) const {
    return before_ ? before_->cell(CellHandle(i)).v : cells_[i];
  }

  TetMesh& mesh_;
  const TetMesh* before_;
  std::size_t n_vertices_, n_cells_;
  std::vector<std::array<VertexHandle, 4>> cells_;
  VertexProperty<Index> source_;
  /// By cell: the old one whose properties it has.
  std::optional<CellProperty<Index>> origin_;
};

/// `maps` of a run, by the handles that the old mesh had before `garbage` was collected.
MeshMaps with_old_handles(const GarbageMap& garbage, const MeshMaps& maps);

}  // namespace hfr

#endif
