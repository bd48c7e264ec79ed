// SPDX-License-Identifier: BSD-3-Clause
#include "Scheduler/RunUntilQuiet.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/EdgeRemoval.hh"
#include "Operators/FaceSwap.hh"

namespace hfr::test {
namespace {

using Removal = EdgeRemoval<VolumeLength>;

std::vector<EdgeHandle> all_edges(const TetMesh& mesh, const Worklist& list) {
  return edge_seeds(mesh, list, {});
}

TEST(RunUntilQuiet, LeavesNoEdgeThatWouldBeRemoved) {
  TetMesh one;
  for (const int threads : {1, 3}) {
    TetMesh mesh = jittered(6, 0.45, 3);
    Workspace work;
    work.attach(mesh, {});
    work.set_qualities(mesh, VolumeLength{}, {});
    const auto op = [&] { return Removal{{}, work.quality}; };
    QuietOptions options;
    options.round.policy = {threads, 1};
    const RoundCounts counts = run_until_quiet(mesh, work, op, all_edges, options);
    EXPECT_GT(counts.winners, 50U);
    EXPECT_GT(counts.rounds, 2U);
    EXPECT_LT(counts.rounds, 100U);
    ASSERT_EQ(check(mesh), Ok);
    const Worklist all(mesh, {}, [](CellHandle) { return true; });
    EXPECT_EQ(Round<Removal>(mesh, work, options.round).run(op(), all_edges(mesh, all)).winners, 0U);
    Cavity cavity;
    Star scratch;
    for (EdgeHandle e : mesh.edges()) {
      const auto plan = op().evaluate(mesh, e);
      if (!plan || !(plan->old_worst > 0)) continue;  // rounds hold more against clusters with inverted cells
      op().cavity(mesh, *plan, cavity);
      EXPECT_FALSE(admissible(mesh, cavity, true, scratch)) << "edge " << e.idx() << " could still go";
    }
    if (threads == 1)
      one = mesh;
    else
      EXPECT_TRUE(identical(one, mesh));
  }
}

/// Never has enough.
struct SplitAny {
  using Seed = CellHandle;
  struct Plan : PlanBase {
    CellHandle seed;
  };
  Volume metric;
  void scope(const TetMesh&, Seed c, Scope& out) const {
    out.clear();
    out.push_back(c);
  }
  std::optional<Plan> evaluate(const TetMesh&, Seed c) const {
    return Plan{{.old_worst = 0, .new_worst = 1, .n_removed = 1, .n_created = 4, .adds_vertex = true}, c};
  }
  void cavity(const TetMesh& mesh, const Plan& plan, Cavity& out) const {
    out.clear();
    out.removed.push_back(plan.seed);
    Vec3 middle;
    for (HalfFaceHandle h : mesh.cell_halffaces(plan.seed)) {
      const auto f = mesh.halfface_vertices(h);
      out.created.push_back({f[0], f[1], f[2], Cavity::kNewVertex});
      middle = middle + 0.25 * mesh.point(mesh.halfface_opposite_vertex(h));
    }
    out.new_vertex = middle;
  }
  Tet identity(const TetMesh& mesh, Seed c) const { return sorted(mesh.cell(c).v); }
};

TEST(RunUntilQuiet, EndsAnOperatorThatAlwaysFindsMore) {
  TetMesh mesh = jittered(2, 0.1, 1);
  const std::size_t n = mesh.n_cells();
  Workspace work;
  work.attach(mesh, {});
  work.set_qualities(mesh, Volume{}, {});
  const auto cells = [](const TetMesh&, const Worklist& list) {
    std::vector<CellHandle> seeds;
    for (Index c : list.cells()) seeds.push_back(CellHandle(c));
    return seeds;
  };
  QuietOptions options;
  options.max_rounds = 3;
  const RoundCounts counts = run_until_quiet(
      mesh, work, [] { return SplitAny{}; }, cells, options);
  EXPECT_EQ(counts.rounds, 3U);
  EXPECT_EQ(mesh.n_cells(), 64 * n);
  EXPECT_EQ(check(mesh), Ok);
}

#ifndef NDEBUG
/// Announces another number of cells than it makes.
struct Miscounts : SplitAny {
  std::optional<Plan> evaluate(const TetMesh& mesh, Seed c) const {
    auto plan = SplitAny::evaluate(mesh, c);
    plan->adds_vertex = false;
    return plan;
  }
};

TEST(RoundDeathTest, StopsWherePlanAndCavityDisagree) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(
      {
        TetMesh mesh = jittered(1, 0.1, 1);
        Workspace work;
        work.attach(mesh, {});
        work.set_qualities(mesh, Volume{}, {});
        const std::vector<CellHandle> seeds(mesh.cells().begin(), mesh.cells().end());
        Round<Miscounts>(mesh, work, {{1, 1}, false, 1}).run(Miscounts{}, seeds);
      },
      "disagreement");
}
#endif

}  // namespace
}  // namespace hfr::test
