// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_CUT_HH
#define HFR_DISTRIBUTED_CUT_HH

#include <span>
#include <vector>

#include "Distributed/PartMessage.hh"
#include "HalfFace/TetMesh.hh"
#include "Scheduler/Workspace.hh"

namespace hfr::mpi {

/// Which cells of a whole mesh each rank holds, and the messages that hand them out. O(n) on all threads of
/// the policy, but for the cells within two edges of vertices of two owners, which one thread looks at.
class Cut {
 public:
  /// `owner`: of each vertex. All have to outlive the cut.
  Cut(const TetMesh& mesh, const Workspace& work, std::span<const int> owner, int n_ranks,
      par::Policy policy);

  /// What this rank holds: the cells with a vertex within two edges of one of its own, ascending.
  Block message(int rank);

 private:
  void find_held(int n_ranks);
  std::vector<Index> vertices_of(std::span<const Index> cells, int rank);
  void write_vertices(std::span<const Index> vertices, std::span<const Index> cells,
                      const PartArrays& out) const;
  void write_cells(std::span<const Index> cells, const PartArrays& out) const;
  /// Place of a cell among those that the message is about; kNothing where it is none of them.
  Index place_of(Index cell, std::span<const Index> cells) const {
    const Index at = cell_[cell];
    return at < cells.size() && cells[at] == cell ? at : PartArrays::kNothing;
  }

  const TetMesh& mesh_;
  const Workspace& work_;
  std::span<const int> owner_;
  par::Policy policy_;
  std::vector<std::vector<Index>> held_;  // by rank
  std::vector<Index> cell_, vertex_;      // places in the message that was written last
  std::vector<std::uint8_t> marks_;       // by vertex
};

}  // namespace hfr::mpi

#endif
