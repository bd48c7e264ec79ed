// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_RANK_FIGURES_HH
#define HFR_DISTRIBUTED_RANK_FIGURES_HH

#include <cstdint>
#include <vector>

#include "hfremesh/Distributed/Comm.hh"

namespace hfr::mpi {

class DistributedMesh;

/// What one rank has done.
struct RankFigures {
  PerPhase<Traffic> traffic{};
  PerPhase<double> seconds{};
  std::uint64_t n_rounds = 0;    ///< shared rounds and smoothing passes
  std::uint64_t peak_bytes = 0;  ///< largest resident memory; 0 where the system does not tell
  /// Of its part, when it was looked at last: own cells, slots of all cells that it holds, and of those with
  /// a vertex within two edges of another's.
  std::uint64_t n_own = 0, n_held = 0, n_border = 0;
  /// Vertices of other ranks that it had for the last run towards a goal, with the cells below that.
  std::uint64_t n_borrowed = 0;
};

/// Fills in what there is to say of a part. O(part).
void look_at_part(const DistributedMesh& mesh, RankFigures& figures);
/// Those of all ranks, on each, with what has been sent, the seconds and the memory up to now. All take part.
std::vector<RankFigures> gather_figures(Comm& comm, RankFigures mine);

/// Largest resident memory of this process; 0 where the system does not tell.
std::uint64_t peak_bytes();

}  // namespace hfr::mpi

#endif
