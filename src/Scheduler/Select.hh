// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_SCHEDULER_SELECT_HH
#define HFR_SCHEDULER_SELECT_HH

#include <cstdint>
#include <functional>
#include <span>
#include <unordered_set>
#include <vector>

#include "HalfFace/TetMesh.hh"
#include "Operators/Cavity.hh"
#include "Parallel/Parallel.hh"
#include "Scheduler/Workspace.hh"  // kUnclaimed

namespace hfr {

/// The scopes of candidates 0 … size()-1 in one array.
class ScopeList {
 public:
  ScopeList() = default;
  /// scope_of(i, out) fills `out` with the cells of candidate i; it is called from several threads.
  template <class ScopeOf>
  ScopeList(par::Policy policy, std::size_t n, ScopeOf&& scope_of) : begin_(n + 1, 0) {
    const int n_parts = par::thread_count(policy, n);
    std::vector<std::vector<CellHandle>> found(static_cast<std::size_t>(n_parts));
    par::parts(n_parts, [&](int part) {
      Scope scope;
      auto& mine = found[static_cast<std::size_t>(part)];
      const std::size_t end = par::part_begin(n, n_parts, part + 1);
      for (std::size_t i = par::part_begin(n, n_parts, part); i < end; ++i) {
        scope_of(i, scope);
        begin_[i] = scope.size();
        mine.insert(mine.end(), scope.begin(), scope.end());
      }
    });
    par::exclusive_scan(std::span(begin_));
    cells_ = std::move(found[0]);
    for (std::size_t p = 1; p < found.size(); ++p)
      cells_.insert(cells_.end(), found[p].begin(), found[p].end());
  }

  std::size_t size() const { return begin_.empty() ? 0 : begin_.size() - 1; }
  std::span<const CellHandle> operator[](std::size_t i) const {
    return {cells_.data() + begin_[i], cells_.data() + begin_[i + 1]};
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<CellHandle> cells_;
};

/// From here on claims are quicker than marks, which cost a fraction of them but run on one thread.
inline constexpr int kClaimThreads = 4;
inline constexpr std::size_t kClaimCandidates = 8192;

/// The lexicographically first independent set: candidate i is in it unless its scope shares a cell with that
/// of an earlier one that is. `claim` has an entry a cell slot, all kUnclaimed; afterwards the cells of
/// winner number w hold w. Returns the winners, ascending. Two ways that always give the same set:
///
/// One loop over the candidates, marking cells: the paper's ASSIGNMENT. `accept(i)`, where given, may refuse
/// a candidate whose cells are free.
std::vector<std::uint32_t> select_by_marking(const ScopeList& scopes, std::span<std::uint32_t> claim,
                                             const std::function<bool(std::size_t)>& accept = {});
/// For accept(): adds the values unless one of them is there.
bool add_unless_there(std::span<const std::uint64_t> values, std::unordered_set<std::uint64_t>& there);
/// Lock-free: every undecided candidate lowers the claim of its cells to its own number; who holds all its
/// cells has won, who meets a winner has lost; repeated until all are decided. `sub_rounds`, where given,
/// gets the number of repetitions.
std::vector<std::uint32_t> select_by_claims(par::Policy policy, const ScopeList& scopes,
                                            std::span<std::uint32_t> claim,
                                            std::size_t* sub_rounds = nullptr);
/// Whichever is quicker for this many candidates and threads.
std::vector<std::uint32_t> select(par::Policy policy, const ScopeList& scopes, std::span<std::uint32_t> claim,
                                  std::size_t* sub_rounds = nullptr);

/// Colour of each candidate, from 0: candidates of one colour share no cell. Colour 0 is the set that
/// select() gives, colour 1 that of the rest, and so on. `n_cells`: cell slots that scopes may name.
std::vector<std::uint32_t> colour_clusters(par::Policy policy, const ScopeList& scopes, std::size_t n_cells);

}  // namespace hfr

#endif
