// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_OPERATORS_ANY_OF_HH
#define HFR_OPERATORS_ANY_OF_HH

#include <algorithm>
#include <tuple>
#include <utility>
#include <variant>

#include "Operators/Operator.hh"

namespace hfr {

/// Several operators as one, so that their candidates compete in one selection (D'Amato & Vénere 2013 propose
/// kernels of several kinds at a time). Among clusters whose worst cells are equally bad, the one that gains
/// most wins; see priority(). A seed is a seed of one of the operators, whose types must differ. All are to
/// use the same metric.
template <LocalOperator... Ops>
struct AnyOf {
  using Seed = std::variant<typename Ops::Seed...>;
  using AnyPlan = std::variant<typename Ops::Plan...>;
  struct Plan : PlanBase {
    Seed seed;
    AnyPlan plan;
  };
  using Metric = decltype(std::tuple_element_t<0, std::tuple<Ops...>>::metric);
  static constexpr bool kRankByGain = true;
  static constexpr double kSeedNanoseconds = std::min({seed_nanoseconds<Ops>()...});

  std::tuple<Ops...> operators;
  Metric metric = std::get<0>(operators).metric;

  void scope(const TetMesh& mesh, const Seed& seed, Scope& out) const {
    with(seed, [&](auto, const auto& op, const auto& s) { op.scope(mesh, s, out); });
  }
  std::optional<Plan> evaluate(const TetMesh& mesh, const Seed& seed) const {
    return with(seed, [&]<std::size_t kIndex>(Index<kIndex>, const auto& op, const auto& s) {
      std::optional<Plan> plan;
      const auto found = op.evaluate(mesh, s);
      if (!found) return plan;
      // An operator may grow its seed while it evaluates: the plan's is the one that has the scope.
      plan.emplace(Plan{*found, Seed(std::in_place_index<kIndex>, found->seed),
                        AnyPlan(std::in_place_index<kIndex>, *found)});
      return plan;
    });
  }
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    with(plan.plan, [&](auto, const auto& op, const auto& p) { op.cavity(mesh, p, out); });
  }
  Tet identity(const TetMesh& mesh, const Seed& seed) const {
    return with(seed, [&](auto, const auto& op, const auto& s) { return op.identity(mesh, s); });
  }

 private:
  template <std::size_t kIndex>
  using Index = std::integral_constant<std::size_t, kIndex>;

  /// f(index, operator, item) with the operator whose turn it is in `items`.
  template <std::size_t kIndex = 0, class Variant, class F>
  auto with(const Variant& items, F&& f) const {
    if constexpr (kIndex + 1 < sizeof...(Ops)) {
      if (items.index() != kIndex) return with<kIndex + 1>(items, f);
    }
    return f(Index<kIndex>(), std::get<kIndex>(operators), *std::get_if<kIndex>(&items));
  }
};

}  // namespace hfr

#endif
