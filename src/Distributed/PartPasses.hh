// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DISTRIBUTED_PART_PASSES_HH
#define HFR_DISTRIBUTED_PART_PASSES_HH

#include <cstdint>
#include <vector>

#include "Distributed/DistributedMesh.hh"
#include "Remesh/PassState.hh"
#include "Remesh/Ranks.hh"
#include "Scheduler/PoorCells.hh"
#include "Scheduler/Seeds.hh"

namespace hfr::mpi {

/// The passes of the polish, of the bulk stage in volume-length, and of untangling, over the parts of a mesh.
/// All ranks call all of it in the same order.
class PartPasses {
 public:
  /// `n_rounds`: counts rounds in which there was something to look at.
  PartPasses(DistributedMesh& parts, std::uint64_t& n_rounds) : parts_(parts), n_rounds_(n_rounds) {}

  static bool can_do(PassKind kind, const RankMetric& metric);
  RoundCounts run(const Ranks::Look& look);
  /// A round of insertion: see PartInsertion.
  RoundCounts dig(const Ranks::Dig& dig, std::vector<std::uint64_t>& waiting);
  /// A round of cluster search, likewise: see PartSearch.
  RoundCounts search(const Ranks::Search& search);
  /// Of all cells of the whole.
  Ranks::Tally tally(double below);
  /// For looks that are marked: vertices of these own cells of all ranks, and of so many layers round them.
  void mark_round(std::span<const CellHandle> cells, int layers);
  /// Cells of the part that a pass has to look at.
  Worklist listed(const Ranks::Look& look);

 private:
  bool is_marked(VertexHandle v) const;
  template <class M>
  RoundCounts pass(const Ranks::Look& look, const M& metric);
  template <class M>
  RoundCounts mixed(const Ranks::Look& look, const M& metric, const Worklist& list);
  template <class Op>
  RoundCounts round(const Ranks::Look& look, const Op& op, const Worklist& list, bool first_does = false);
  std::uint64_t n_own(std::span<const Index> cells) const;

  std::vector<std::uint64_t> marked_;  // numbers of vertices, ascending
  std::uint64_t newer_from_ = 0;       // and these, which have come since
  DistributedMesh& parts_;
  std::uint64_t& n_rounds_;
  PoorCells poor_;  // of the part
};

}  // namespace hfr::mpi

#endif
