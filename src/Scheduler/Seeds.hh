// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_SEEDS_HH
#define HFR_SCHEDULER_SEEDS_HH

#include <cstdint>
#include <span>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Parallel/Parallel.hh"

namespace hfr {

/// Cells to be looked at, ascending, and a flag per cell slot that says the same.
class Worklist {
 public:
  /// Cells c with keep(c), deleted ones left out.
  template <class Keep>
  Worklist(const TetMesh& mesh, par::Policy policy, Keep&& keep) : listed_(mesh.n_cells(), 0) {
    cells_ = par::compact<Index>(policy, mesh.n_cells(), [&](std::size_t i) {
      if (mesh.is_deleted(CellHandle(i)) || !keep(CellHandle(i))) return false;
      listed_[i] = 1;
      return true;
    });
  }

  std::span<const Index> cells() const { return cells_; }
  bool has(CellHandle c) const { return listed_[c.idx()] != 0; }

 private:
  std::vector<Index> cells_;
  std::vector<std::uint8_t> listed_;
};

/// Inner edges of the listed cells, each once: from the smallest listed cell of its ring.
std::vector<EdgeHandle> edge_seeds(const TetMesh& mesh, const Worklist& list, par::Policy policy);
/// Inner faces of the listed cells, each once: from the smaller listed half-face.
std::vector<HalfFaceHandle> face_seeds(const TetMesh& mesh, const Worklist& list, par::Policy policy);
/// Vertices of the listed cells that are not frozen, ascending.
std::vector<VertexHandle> vertex_seeds(const TetMesh& mesh, const Worklist& list,
                                       std::span<const std::uint8_t> frozen, par::Policy policy);

}  // namespace hfr

#endif
