// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_REPLACE_HH
#define HFR_OPERATORS_REPLACE_HH

#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/Operators/Cavity.hh"
#include "hfremesh/Operators/Operator.hh"
#include "hfremesh/Quality/Decisions.hh"

namespace hfr {

/// Writes one cavity by itself, incident cells included: taking slots from the free list, appending where it
/// is empty.
void replace(TetMesh& mesh, const Cavity& cavity);

/// Evaluates one seed and, if its cluster gets better and nothing forbids it, commits: for tests, examples
/// and scripts that work on one cluster at a time.
template <LocalOperator Op>
bool apply(const Op& op, TetMesh& mesh, typename Op::Seed seed) {
  const auto plan = op.evaluate(mesh, seed);
  if (!plan) return false;
  Cavity cavity;
  op.cavity(mesh, *plan, cavity);
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
