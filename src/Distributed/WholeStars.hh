// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_WHOLE_STARS_HH
#define HFR_DISTRIBUTED_WHOLE_STARS_HH

#include <optional>

#include "HalfFace/TetMesh.hh"
#include "Operators/PinchedStars.hh"
#include "Scheduler/Workspace.hh"

namespace hfr::mpi {

/// All cells that a part holds of a vertex, also of a pinched one, round which a walk does not see them all.
/// Good until the next change of the part. The first pinched vertex that is asked about costs a look at all
/// cells.
class WholeStars {
 public:
  WholeStars(const TetMesh& part, const Workspace& work) : part_(part), work_(work) {}

  /// visit(c), each once.
  template <class Visit>
  void for_cells(VertexHandle v, Visit&& visit) {
    if (work_.pinched.empty() || work_.pinched[v.idx()] == 0) {
      for (CellHandle c : part_.vertex_cells(v)) visit(c);
      return;
    }
    if (!pinched_) pinched_.emplace(part_, work_.pinched, par::Policy{});
    for (CellHandle c : pinched_->cells(v)) visit(c);
  }

 private:
  const TetMesh& part_;
  const Workspace& work_;
  std::optional<PinchedStars> pinched_;
};

}  // namespace hfr::mpi

#endif
