// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "Operators/Operator.hh"

namespace hfr {

std::string_view disagreement(const PlanBase& plan, const Cavity& cavity, std::span<const CellHandle> scope) {
  if (cavity.moved.is_valid()) {
    if (!cavity.dead.empty() || !cavity.born.empty())
      return "a cavity that moves a vertex has dead or born cells";
    if (plan.n_dead != 0 || plan.n_born != 0)
      return "n_dead or n_born of a plan that moves a vertex is not 0";
    return {};
  }
  if (plan.n_dead != cavity.dead.size()) return "n_dead is not the number of dead cells";
  if (plan.n_born != cavity.born.size()) return "n_born is not the number of born cells";
  if (!std::equal(cavity.dead.begin(), cavity.dead.end(), scope.begin(), scope.end()))
    return "the dead cells are not those of the scope, in its order";
  if (plan.n_dead_first != cavity.n_dead_first || plan.n_born_first != cavity.n_born_first)
    return "plan and cavity have other numbers of cells in the first region";
  if (plan.removes_vertex != cavity.removed.is_valid())
    return "removes_vertex does not say what the cavity does";
  if (plan.adds_vertex != cavity.new_vertex.has_value())
    return "adds_vertex does not say what the cavity does";
  const bool uses_new = std::any_of(cavity.born.begin(), cavity.born.end(), [](const Tet& t) {
    return std::find(t.begin(), t.end(), Cavity::kNewVertex) != t.end();
  });
  if (uses_new && !cavity.new_vertex) return "a born cell has the new vertex, which has no place";
  return {};
}

}  // namespace hfr
