// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/VertexInsertion.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"
#include "Operators/Dig.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<VertexInsertion<VolumeLength>>);
static_assert(LocalOperator<VertexInsertion<MinSine2>>);
static_assert(EvaluatesInParts<VertexInsertion<MinSine2>>);

template <class Metric>
using Seed = typename VertexInsertion<Metric>::Seed;

/// Outer half-faces by comparing vertices only.
std::set<std::array<VertexHandle, 3>> faces_by_vertices(const TetMesh& mesh,
                                                        const std::vector<CellHandle>& cells) {
  std::set<std::array<VertexHandle, 3>> set;
  for (const auto& f : outer_faces(mesh, cells)) set.insert(f);
  return set;
}

TEST(GrownCells, OuterFacesAreThoseOfTheCellsAndNoVertexGoesUnder) {
  Engine engine(4);
  int grown = 0;
  int refused = 0;
  for (std::uint64_t s = 1; s <= 30; ++s) {
    const TetMesh mesh = jittered(4, 0.2, s);
    GrownCells cells(mesh, C(engine() % mesh.n_cells()));
    for (int i = 0; i < 200; ++i) {
      const HalfFaceHandle h = cells.outer()[engine() % cells.outer().size()];
      const std::size_t n = cells.cells().size();
      const bool can = cells.grow(h);
      can ? ++grown : ++refused;
      EXPECT_EQ(cells.cells().size(), n + (can ? 1 : 0));
    }
    const std::vector<CellHandle> list(cells.cells().begin(), cells.cells().end());
    const std::set<CellHandle> distinct(list.begin(), list.end());
    EXPECT_EQ(distinct.size(), list.size());
    std::set<std::array<VertexHandle, 3>> outer;
    for (HalfFaceHandle h : cells.outer()) outer.insert(mesh.halfface_vertices(h));
    EXPECT_TRUE(outer == faces_by_vertices(mesh, list));
    EXPECT_EQ(outer.size(), cells.outer().size());
    std::set<VertexHandle> on_surface, all;
    for (const auto& f : outer) on_surface.insert(f.begin(), f.end());
    for (CellHandle c : list)
      for (VertexHandle v : mesh.cell(c).v) all.insert(v);
    EXPECT_TRUE(on_surface == all);
    Scope scope;
    cells.growth().cells(mesh, scope);
    EXPECT_TRUE(std::equal(scope.begin(), scope.end(), list.begin(), list.end()));
  }
  EXPECT_GT(grown, 500);
  EXPECT_GT(refused, 200);
}

TEST(Dig, APlaceIsWithinReachWhereAsMuchAgainWouldDo) {
  const auto site = [](double old_worst, double new_worst) {
    detail::Site s;
    s.old_worst = old_worst;
    s.new_worst = new_worst;
    return s;
  };
  const auto within = [&](double before, double now, double gain) {
    return detail::is_within_reach(site(0.1, 0.1 * before), site(0.2, 0.2 * now), gain);
  };
  EXPECT_TRUE(within(1.0, 1.3, 1.6));   // 1.69
  EXPECT_FALSE(within(1.0, 1.2, 1.6));  // 1.44
  EXPECT_TRUE(within(1.59, 1.61, 1.6));
  EXPECT_TRUE(within(0.5, 0.8, 1.02));  // 1.28, and not yet as good as what goes
  EXPECT_FALSE(within(0.9, 0.95, 1.02));
  EXPECT_TRUE(detail::is_within_reach(site(0, 0.1), site(0.1, 0.11), 1.6));  // of a flat cell any is
  EXPECT_TRUE(detail::is_within_reach(site(0.1, 0.1), site(-0.1, 0.11), 1.6));
}

TEST(VertexInsertion, LeavingEarlyFindsNoOtherPlansAndMissesFew) {
  int n_all = 0, n_early = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const TetMesh mesh = jittered(4, 0.24, seed);
    const std::vector<double> quality = qualities(mesh, MinSine2{});
    VertexInsertion<MinSine2> all{MinSine2{}, quality, 1.6};
    VertexInsertion<MinSine2> early = all;
    early.leaves_early = true;
    for (CellHandle c : mesh.cells()) {
      const auto plan = all.evaluate(mesh, CellSeed(c)), quick = early.evaluate(mesh, CellSeed(c));
      n_all += plan ? 1 : 0;
      n_early += quick ? 1 : 0;
      if (!quick) continue;
      ASSERT_TRUE(plan);
      EXPECT_GT(quick->new_worst, 1.6 * quick->old_worst);
      EXPECT_LE(quick->new_worst, plan->new_worst);
    }
  }
  EXPECT_GT(n_all, 50);
  EXPECT_LT(n_early, n_all);
  EXPECT_GT(n_early, 9 * n_all / 10);
}

template <class Metric>
class VertexInsertionMetrics : public testing::Test {};
using AllMetrics = testing::Types<VolumeLength, MinSine2, MinDihedral>;
TYPED_TEST_SUITE(VertexInsertionMetrics, AllMetrics);

TYPED_TEST(VertexInsertionMetrics, AcceptedCavitiesKeepVolumeAndRaiseTheWorst) {
  const TypeParam metric;
  int accepted = 0;
  int dug = 0;
  for (std::uint64_t s = 1; s <= 6; ++s) {
    TetMesh mesh = jittered(4, 0.35, s);
    const auto boundary = boundary_of(mesh);
    for (std::size_t i = 0; i < mesh.n_cells() && i < 384; i += 3) {
      if (mesh.is_deleted(C(i))) continue;
      const auto quality = qualities(mesh, metric);
      const double before = volume(mesh);
      const VertexInsertion<TypeParam> op{metric, quality};
      const auto plan = op.evaluate(mesh, Seed<TypeParam>(C(i)));
      if (!plan) continue;
      const Cavity cavity = cavity_of(op, mesh, *plan);
      const VertexHandle fresh(mesh.n_vertices());
      Star scratch;
      if (!admissible(mesh, cavity, true, scratch)) continue;
      ++accepted;
      dug += plan->n_removed > 1 ? 1 : 0;
      replace(mesh, cavity);
      double new_worst = std::numeric_limits<double>::infinity();
      std::size_t n_created = 0;
      for (CellHandle c : mesh.cells()) {
        if (!mesh.cell(c).has(fresh)) continue;
        ++n_created;
        new_worst = std::min(new_worst, quality_of(mesh, mesh.cell(c).v, metric));
      }
      EXPECT_EQ(n_created, plan->n_created);
      EXPECT_EQ(new_worst, plan->new_worst) << "the plan is not what it claims";
      const CheckResult result = check(mesh);
      EXPECT_EQ(result, Ok);
      if (!result) return;
      EXPECT_NEAR(volume(mesh), before, 1e-12);
      EXPECT_TRUE(boundary_of(mesh) == boundary);
    }
  }
  EXPECT_GT(accepted, 60);
  EXPECT_GT(dug, 50);
}

TEST(VertexInsertion, PartsOfAStepMayComeInAnyOrder) {
  int n_plans = 0;
  for (std::uint64_t s = 1; s <= 4; ++s) {
    const TetMesh mesh = jittered(4, 0.35, s);
    const auto quality = qualities(mesh, MinSine2{});
    VertexInsertion<MinSine2> op{{}, quality};
    op.least_promise = s % 2 == 0 ? 0.5 : 0;
    if (s == 3) op.max_sites = 3;
    for (std::size_t i = 0; i < mesh.n_cells(); i += 5) {
      const Seed<MinSine2> seed(C(i));
      VertexInsertion<MinSine2>::Parts parts(seed);
      int step = 0;
      for (std::size_t n = 0; (n = op.n_parts(parts, step)) > 0; ++step)
        for (std::size_t k = n; k-- > 0;) op.evaluate_part(mesh, parts, step, k);
      EXPECT_EQ(op.n_parts(parts, step + 1), 0U);
      const auto expected = op.evaluate(mesh, seed);
      const auto plan = op.plan(mesh, parts);
      ASSERT_EQ(plan.has_value(), expected.has_value());
      if (!plan) continue;
      ++n_plans;
      EXPECT_EQ(plan->place, expected->place);
      EXPECT_EQ(plan->new_worst, expected->new_worst);
      EXPECT_EQ(plan->n_removed, expected->n_removed);
      EXPECT_EQ(plan->seed.growth.steps, expected->seed.growth.steps);
    }
  }
  EXPECT_GT(n_plans, 100);
}

TEST(VertexInsertion, SliverAmongFrozenVerticesIsMended) {
  // Four vertices all but in one plane between two apexes, all of them on the surface.
  TetMesh mesh =
      build({{-1, 0, 0.05}, {1, 0, 0.05}, {0, -1, -0.05}, {0, 1, -0.05}, {0, 0, 1.2}, {0, 0, -1.2}},
            std::vector<Corners>{{0, 1, 3, 2}, {0, 3, 1, 4}, {0, 1, 2, 4}, {2, 3, 0, 5}, {3, 2, 1, 5}});
  ASSERT_EQ(check(mesh), Ok);
  auto quality = qualities(mesh, MinSine2{});
  const CellHandle worst(
      static_cast<std::size_t>(std::min_element(quality.begin(), quality.end()) - quality.begin()));
  ASSERT_GT(quality[worst.idx()], 0);
  const double before = quality[worst.idx()];
  ASSERT_TRUE(apply(VertexInsertion<MinSine2>{{}, quality}, mesh, Seed<MinSine2>(worst)));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(worst_quality(mesh, MinSine2{}), 10 * before);
}

TEST(VertexInsertion, NeedlesOfTheSurfaceGetAnApexOfTheirOwn) {
  // A needle whose apex stands over its middle; its best one is near the short side.
  TetMesh mesh = build({{0, 0, 0}, {5, -0.15, 0}, {5, 0.15, 0}, {2.5, 0, 3}, {2.5, -3, 1}, {2.5, 3, 1}},
                       std::vector<Corners>{{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 2, 3, 5}});
  ASSERT_EQ(check(mesh), Ok);
  const auto quality = qualities(mesh, MinSine2{});
  const auto plan = VertexInsertion<MinSine2>{{}, quality}.evaluate(mesh, Seed<MinSine2>(C(0)));
  ASSERT_TRUE(plan);
  EXPECT_GT(plan->new_worst, 2 * plan->old_worst);
}

TEST(VertexInsertion, FollowsUpTheSitesThatItIsToldAndMayLose) {
  int lost = 0;
  int differ = 0;
  for (std::uint64_t s = 1; s <= 3; ++s) {
    const TetMesh mesh = jittered(4, 0.2, s);
    const auto quality = qualities(mesh, MinSine2{});
    for (std::size_t i = 0; i < mesh.n_cells(); i += 17) {
      VertexInsertion<MinSine2> op{{}, quality, 0.05};
      double best = 0;
      for (int site = 0; site < static_cast<int>(op.kMaxSites); ++site) {
        op.only_site = site;
        const auto plan = op.evaluate(mesh, Seed<MinSine2>(C(i)));
        if (!plan) continue;
        EXPECT_GT(plan->new_worst, 0.05 * plan->old_worst);
        lost += plan->new_worst < plan->old_worst ? 1 : 0;
        differ += best > 0 && plan->new_worst != best ? 1 : 0;
        best = std::max(best, plan->new_worst);
      }
      op.only_site = -1;
      const auto all = op.evaluate(mesh, Seed<MinSine2>(C(i)));
      ASSERT_EQ(all.has_value(), best > 0);
      if (all) {
        EXPECT_EQ(all->new_worst, best);
      }
      op.max_sites = 1;
      const auto first = op.evaluate(mesh, Seed<MinSine2>(C(i)));
      if (first) {
        EXPECT_LE(first->new_worst, best);
      }
    }
  }
  EXPECT_GT(lost, 50);
  EXPECT_GT(differ, 50);
}

TEST(VertexInsertion, AVertexForOnePlaceStaysThere) {
  int planned = 0;
  int applied = 0;
  int lost = 0;
  for (std::uint64_t s = 1; s <= 3; ++s) {
    const TetMesh first = jittered(4, 0.2, s);
    const auto quality = qualities(first, MinSine2{});
    for (std::size_t i = 0; i < first.n_cells(); i += 7) {
      const auto& v = first.cell(C(i)).v;
      VertexInsertion<MinSine2> op{{}, quality, 1e-3};
      op.only_place = 0.4 * first.point(v[0]) + 0.3 * first.point(v[1]) + 0.2 * first.point(v[2]) +
                      0.1 * first.point(v[3]);
      const auto plan = op.evaluate(first, Seed<MinSine2>(C(i)));
      if (!plan) continue;
      ++planned;
      EXPECT_EQ(plan->place, *op.only_place);
      EXPECT_GT(plan->new_worst, 1e-3 * plan->old_worst);
      lost += plan->new_worst < plan->old_worst ? 1 : 0;
      op.gain = 1;
      const auto better = op.evaluate(first, Seed<MinSine2>(C(i)));
      EXPECT_EQ(better.has_value(), plan->new_worst > plan->old_worst);
      TetMesh mesh = first;
      op.gain = 1e-3;
      if (!apply(op, mesh, Seed<MinSine2>(C(i)))) continue;
      ++applied;
      EXPECT_EQ(check(mesh), Ok);
      EXPECT_EQ(mesh.point(V(mesh.n_vertices() - 1)), *op.only_place);
    }
  }
  EXPECT_GT(planned, 100);
  EXPECT_GT(applied, 100);
  EXPECT_GT(lost, 50);
}

TEST(VertexInsertion, PlacesWithoutPromiseAreNotFollowedUp) {
  int same = 0;
  int given_up = 0;
  for (std::uint64_t s = 1; s <= 3; ++s) {
    const TetMesh mesh = jittered(4, 0.3, s);
    const auto quality = qualities(mesh, MinSine2{});
    VertexInsertion<MinSine2> op{{}, quality, 1.1};
    op.max_sites = 1;
    for (std::size_t i = 0; i < mesh.n_cells(); i += 2) {
      op.least_promise = 0;
      const auto any = op.evaluate(mesh, Seed<MinSine2>(C(i)));
      op.least_promise = 0.9;
      const auto promising = op.evaluate(mesh, Seed<MinSine2>(C(i)));
      if (promising) {
        ASSERT_TRUE(any);
        EXPECT_EQ(promising->place, any->place);
        EXPECT_EQ(promising->new_worst, any->new_worst);
        ++same;
      } else if (any) {
        ++given_up;
      }
    }
  }
  EXPECT_GT(same, 50);
  EXPECT_GT(given_up, 20);
}

TEST(VertexInsertion, PoorCellsDoNotMultiply) {
  const double below = 0.3;
  const auto n_poor = [&](const std::vector<double>& values) {
    return std::count_if(values.begin(), values.end(), [&](double q) { return q < below; });
  };
  int kept = 0;
  int others = 0;  // plans that the rule changes or refuses
  for (std::uint64_t s = 1; s <= 3; ++s) {
    const TetMesh first = jittered(4, 0.3, s);
    const auto quality = qualities(first, MinSine2{});
    VertexInsertion<MinSine2> op{{}, quality};
    for (std::size_t i = 0; i < first.n_cells(); i += 2) {
      op.poor_below = 0;
      const auto any = op.evaluate(first, Seed<MinSine2>(C(i)));
      op.poor_below = below;
      const auto plan = op.evaluate(first, Seed<MinSine2>(C(i)));
      ASSERT_TRUE(any || !plan);
      others += any && (!plan || !(plan->place == any->place)) ? 1 : 0;
      if (!plan) continue;
      TetMesh mesh = first;
      Cavity cavity;
      op.cavity(mesh, *plan, cavity);
      Star scratch;
      if (!admissible(mesh, cavity, true, scratch)) continue;
      replace(mesh, cavity);
      EXPECT_LE(n_poor(qualities(mesh, MinSine2{})), n_poor(quality) + op.kMorePoor);
      ++kept;
    }
  }
  EXPECT_GT(kept, 50);
  EXPECT_GT(others, 20);
}

TEST(VertexInsertion, InterfacesAreNotDugThrough) {
  int accepted = 0;
  for (std::uint64_t s = 1; s <= 4; ++s) {
    TetMesh mesh = jittered(4, 0.35, s);
    for (CellHandle c : mesh.cells()) mesh.set_region(c, static_cast<int>(c.idx() % 7 == 0));
    const auto quality = qualities(mesh, MinSine2{});
    const VertexInsertion<MinSine2> op{{}, quality};
    for (CellHandle c : mesh.cells()) {
      const auto plan = op.evaluate(mesh, Seed<MinSine2>(c));
      if (!plan) continue;
      ++accepted;
      Scope scope;
      op.scope(mesh, plan->seed, scope);
      for (CellHandle d : scope) EXPECT_EQ(mesh.region(d), mesh.region(c));
    }
  }
  EXPECT_GT(accepted, 30);
}

TEST(VertexInsertion, NothingIsGainedNoPlan) {
  const TetMesh mesh = jittered(3, 0.2, 1);
  const std::vector<double> quality(mesh.n_cells(), 0.9);  // better than any cell
  const VertexInsertion<MinSine2> op{{}, quality};
  for (CellHandle c : mesh.cells()) EXPECT_FALSE(op.evaluate(mesh, Seed<MinSine2>(c)));
}

}  // namespace
}  // namespace hfr::test
