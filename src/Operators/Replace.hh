// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_REPLACE_HH
#define HFR_OPERATORS_REPLACE_HH

#include <optional>
#include <span>
#include <vector>

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Operators/Cavity.hh"
#include "hfremesh/Operators/Operator.hh"
#include "hfremesh/Quality/Decisions.hh"

namespace hfr {

/// An outer face of a cavity: where it was, what lies behind it, and where it is now.
struct OuterFace {
  HalfFaceHandle before;  ///< of the dead cell
  HalfFaceHandle behind;  ///< its mate before the round, invalid on the boundary
  HalfFaceHandle after;   ///< of the born cell
};

/// Commit A. Writes the born cells into `slots` (as many as there are born cells; dead cells first) and links
/// them with each other; appends the outer faces to `notes`. Dead cells beyond the slots are marked deleted.
/// Touches no cell outside the cavity and its slots, so cavities that share no cell may be written
/// concurrently. `new_vertex` stands in for Cavity::kNewVertex. Outside mates are left to the caller (commit
/// B).
void write_cells(TetMesh& mesh, const Cavity& cavity, std::span<const CellHandle> slots,
                 VertexHandle new_vertex, std::vector<OuterFace>& notes);

/// Writes one cavity by itself, hooks included: taking slots from the free list, appending where it is empty.
void replace(TetMesh& mesh, const Cavity& cavity);

/// Evaluates one seed and, if its cluster gets better and nothing forbids it, commits: for tests, examples
/// and scripts that work on one cluster at a time.
template <LocalOperator Op>
bool apply(const Op& op, TetMesh& mesh, typename Op::Seed seed) {
  const auto plan = op.evaluate(mesh, seed);
  if (!plan) return false;
  Cavity cavity;
  op.commit(mesh, *plan, cavity);
#ifndef NDEBUG
  Scope scope;
  op.scope(mesh, plan->seed, scope);
  HFR_ASSERT(disagreement(*plan, cavity, scope).empty());
#endif
  Star scratch;
  if (!admissible(mesh, cavity, true, scratch)) return false;
  if (!(plan->old_worst > 0)) {
    Scope cells;
    op.scope(mesh, plan->seed, cells);
    if (worsens_damage(mesh, cavity, cells, kNoFloor)) return false;
  }
  replace(mesh, cavity);
  return true;
}

}  // namespace hfr

#endif
