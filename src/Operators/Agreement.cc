// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "Operators/Operator.hh"

namespace hfr {

std::string_view disagreement(const PlanBase& plan, const Cavity& cavity, std::span<const CellHandle> scope) {
  if (cavity.moved.is_valid()) {
    if (!cavity.removed.empty() || !cavity.created.empty())
      return "a cavity that moves a vertex has removed or created cells";
    if (plan.n_removed != 0 || plan.n_created != 0)
      return "n_removed or n_created of a plan that moves a vertex is not 0";
    return {};
  }
  if (plan.n_removed != cavity.removed.size()) return "n_removed is not the number of removed cells";
  if (plan.n_created != cavity.created.size()) return "n_created is not the number of created cells";
  if (!std::equal(cavity.removed.begin(), cavity.removed.end(), scope.begin(), scope.end()))
    return "the removed cells are not those of the scope, in its order";
  if (plan.n_removed_first != cavity.n_removed_first || plan.n_created_first != cavity.n_created_first)
    return "plan and cavity have other numbers of cells in the first region";
  if (plan.removes_vertex != cavity.removed_vertex.is_valid())
    return "removes_vertex does not say what the cavity does";
  if (plan.adds_vertex != cavity.new_vertex.has_value())
    return "adds_vertex does not say what the cavity does";
  const bool uses_new = std::any_of(cavity.created.begin(), cavity.created.end(), [](const Tet& t) {
    return std::find(t.begin(), t.end(), Cavity::kNewVertex) != t.end();
  });
  if (uses_new && !cavity.new_vertex) return "a created cell has the new vertex, which has no place";
  return {};
}

}  // namespace hfr
