// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_RUN_UNTIL_QUIET_HH
#define HFR_SCHEDULER_RUN_UNTIL_QUIET_HH

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "hfremesh/Scheduler/Round.hh"
#include "hfremesh/Scheduler/Seeds.hh"
#include "hfremesh/Scheduler/Workspace.hh"

namespace hfr {

struct QuietOptions {
  RoundOptions round = {};
  /// An operator that always finds more to do, such as one that splits, is ended after so many.
  std::size_t max_rounds = 100;
};

/// Rounds of one operator until it finds nothing more to do: over the seeds of all cells first, then over
/// those of the cells that the round before has made or moved, and, when these are quiet, over all once more,
/// which has to be quiet as well. The result depends on mesh, operator and options, not on threads.
///  - `work` is attached to the mesh and has its qualities in the operator's metric; its pending bits are
///    used up.
///  - make_op() gives the operator, holding the workspace's spans as they then are: asked before each round,
///    since a round may move them.
///  - seeds_of(mesh, list) gives the seeds of the listed cells, each once: edge_seeds() and so on.
/// Returns the counts of all rounds. Deleted cells stay until collect_garbage().
template <class MakeOp, class SeedsOf>
RoundCounts run_until_quiet(TetMesh& mesh, Workspace& work, MakeOp&& make_op, SeedsOf&& seeds_of,
                            const QuietOptions& options = {}) {
  using Op = std::remove_cvref_t<decltype(make_op())>;
  static_assert(LocalOperator<Op>);
  RoundCounts counts;
  bool all = true;
  while (counts.rounds < options.max_rounds) {
    const Worklist list(mesh, options.round.policy,
                        [&](CellHandle c) { return all || work.pending[c.idx()] != 0; });
    std::fill(work.pending.begin(), work.pending.end(), std::uint8_t{0});
    const RoundCounts last = Round<Op>(mesh, work, options.round).run(make_op(), seeds_of(mesh, list));
    counts += last;
    if (last.winners == 0 && all) break;
    all = last.winners == 0;
  }
  return counts;
}

}  // namespace hfr

#endif
