// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_WRITER_HH
#define HFR_HALFFACE_WRITER_HH

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Atomic.hh"

namespace hfr {

/// In place: values[i] goes to to[i], which ascend, of n; those between become `none`.
template <class T>
void open_gaps(std::span<const VertexHandle> to, std::size_t n, const T& none, std::vector<T>& values) {
  values.resize(n, none);
  std::size_t i = to.size();
  for (std::size_t place = n; place-- > 0;) {
    if (i == 0 || to[i - 1].idx() != place)
      values[place] = none;
    else if (--i == place)
      return;  // so are all before
    else
      values[place] = std::move(values[i]);
  }
}

/// Low-level writing of a mesh, for builders and operators. Nothing is checked: between two calls the mesh
/// may break every rule of check(), and whoever writes sees to it that it keeps them in the end. Operators of
/// one's own need none of it: rounds and replace() write what their cavities say. Distinct cells, half-faces
/// and vertices may be written in parallel.
class TetMesh::Writer {
 public:
  explicit Writer(TetMesh& mesh) : mesh_(mesh) {}

  Cell& cell(CellHandle c) {
    outdate_hand_index();
    return mesh_.cells_[c.idx()];
  }
  void set_mate(HalfFaceHandle h, HalfFaceHandle m) {
    outdate_hand_index();
    mesh_.cells_[h.idx() / 4].mate[h.idx() % 4] = m;
  }
  void set_incident_cell(VertexHandle v, CellHandle c) { mesh_.incident_cell_[v.idx()] = c; }
  CellHandle& incident_cell(VertexHandle v) { return mesh_.incident_cell_[v.idx()]; }
  /// Neither does it go on the free list, nor do others learn of it.
  void mark_deleted(CellHandle c) { cell(c) = Cell{}; }
  void mark_deleted(VertexHandle v) { mesh_.mark_deleted(v); }
  /// New cells are deleted ones, not on the free list.
  void resize_cells(std::size_t n) { mesh_.resize_cells(n); }
  /// Vertex i becomes to[i], which ascend, of n: those between are new ones without cells, at the origin. All
  /// that hangs on vertices or names them follows, but for properties of edges and faces, of which the mesh
  /// must have none. O(mesh).
  void open_gaps(std::span<const VertexHandle> to, std::size_t n);
  /// Deleted cells that wait for reuse, in the order in which they are to be taken (from the back).
  std::vector<CellHandle>& free_cells() { return mesh_.free_cells_; }
  /// Also of edges and faces that no cell has, as in a part of a mesh.
  Locks& locks() { return mesh_.locks_; }

 private:
  void outdate_hand_index() {  // operators write from several threads at once
    const auto state = par::atomic(mesh_.hand_index_state_);
    if (state.load(std::memory_order_relaxed) != kVoid) state.store(kVoid, std::memory_order_relaxed);
  }

  TetMesh& mesh_;
};

}  // namespace hfr

#endif
