// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_RANK_PASSES_HH
#define HFR_REMESH_RANK_PASSES_HH

#include <cstdint>
#include <optional>
#include <vector>

#include "Remesh/PassState.hh"
#include "Remesh/Ranks.hh"

namespace hfr {

/// The passes of a stage on several ranks. The mesh stays there from one pass to the next, and comes back
/// when a pass that runs here or the end of the stage asks for it: each hand-over is a line "gather" in
/// the report. Only stages whose passes have a focus and, unless the ranks keep the mesh, no invalid cell:
/// docs/distributed.md says which.
class RankPasses {
 public:
  /// `metric`: that of the passes. Nothing is done unless the run has ranks.
  RankPasses(PassState& state, const RankMetric& metric);
  ~RankPasses();
  RankPasses(const RankPasses&) = delete;
  RankPasses& operator=(const RankPasses&) = delete;

  /// Changes that a pass has committed; nothing where it does not run there: then the mesh is here. 0 where
  /// it is left out; see Ranks::keep_mesh().
  std::optional<std::size_t> run(PassKind kind, const char* name, const Turn& turn);
  /// The same for insertion where the ranks keep the mesh: rounds as PassRunner has them.
  std::size_t insert(const char* name, const Turn& turn, double gain);
  void forget_waiting() { waiting_.clear(); }
  bool is_resident() const { return is_resident_; }
  void bring_back();
  std::size_t n_below(double value) { return state_.run_.ranks->tally(value).n_below; }

 private:
  bool takes(PassKind kind, const Turn& turn);
  bool checks_links(PassKind kind);
  /// What the next round of a pass has to know.
  void renew(Ranks::Look& look, const Turn& turn);
  /// Brings the counts of the stage up to date.
  void count(const Turn& turn);

  PassState& state_;
  RankMetric metric_;
  bool is_resident_ = false;
  std::vector<std::uint64_t> waiting_;  // numbers of cells, for their turn in insert()
};

}  // namespace hfr

#endif
