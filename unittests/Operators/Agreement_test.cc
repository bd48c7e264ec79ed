// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

/// A cell that is cut into four, as plan, cavity and scope.
struct Cut {
  PlanBase plan{.old_worst = 0, .new_worst = 1, .n_removed = 1, .n_created = 4, .adds_vertex = true};
  Cavity cavity;
  Scope scope;
  Cut() {
    scope.push_back(C(0));
    cavity.removed.push_back(C(0));
    for (int i = 0; i < 4; ++i) cavity.created.push_back({V(0), V(1), V(2), Cavity::kNewVertex});
    cavity.new_vertex = Vec3{};
  }
  std::string_view says() const { return disagreement(plan, cavity, scope); }
};

TEST(Agreement, OfPlanAndCavity) { EXPECT_EQ(Cut().says(), ""); }

TEST(Agreement, EachWayToDiffer) {
  const auto expect = [](const char* part, auto&& spoil) {
    Cut cut;
    spoil(cut);
    EXPECT_NE(cut.says().find(part), std::string_view::npos) << part << " / " << cut.says();
  };
  expect("n_removed", [](Cut& c) { c.plan.n_removed = 2; });
  expect("n_created", [](Cut& c) { c.plan.n_created = 3; });
  expect("scope", [](Cut& c) { c.scope[0] = C(7); });
  expect("first region", [](Cut& c) { c.cavity.n_created_first = 1; });
  expect("removes_vertex", [](Cut& c) { c.plan.removes_vertex = true; });
  expect("adds_vertex", [](Cut& c) { c.plan.adds_vertex = false; });
  expect("no place", [](Cut& c) {
    c.plan.adds_vertex = false;
    c.cavity.new_vertex.reset();
  });
  expect("moves a vertex", [](Cut& c) { c.cavity.moved = V(0); });
  expect("moves a vertex", [](Cut& c) {
    c.cavity.clear();
    c.cavity.moved = V(0);
  });
}

}  // namespace
}  // namespace hfr::test
