// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/FanMerge.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<FanMerge<VolumeLength>>);
static_assert(LocalOperator<FanMerge<MinSine2>>);

/// k cells in a row round the edge from 0 to 1, whose outer vertices 2 … k+2 span `angle`; those between the
/// first and the last bulge.
TetMesh fan(std::size_t k, double angle, Engine& engine) {
  std::vector<Vec3> points = {{0, 0, -0.7}, {0, 0, 0.7}};
  for (std::size_t i = 0; i <= k; ++i) {
    const bool inside = i > 0 && i < k;
    const double share =
        (static_cast<double>(i) + (inside ? uniform(engine, -0.4, 0.4) : 0.0)) / static_cast<double>(k);
    const double turn = angle * share;
    const double radius = inside ? uniform(engine, 1.0, 2.2) : uniform(engine, 0.6, 1.1);
    points.push_back({radius * std::cos(turn), radius * std::sin(turn), uniform(engine, -0.2, 0.2)});
  }
  std::vector<Corners> cells;
  for (Index i = 0; i < k; ++i) cells.push_back({0, 1, i + 2, i + 3});
  return build(points, cells);
}

/// Best worst cell over all rows of three and more cells that hold cell `at`, and all triangulations.
template <class Metric>
double brute_force(const TetMesh& mesh, std::size_t k, std::size_t at, const Metric& metric) {
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i <= at; ++i) {
    for (std::size_t j = std::max(at + 1, i + 3); j <= k; ++j) {
      for (const auto& triangulation : triangulations(i, j)) {
        std::vector<Tet> tets = cells_on(triangulation);
        tets.push_back({V(0), V(1), V(i + 2), V(j + 2)});
        best = std::max(best, worst_of_tets(mesh, tets, metric));
      }
    }
  }
  return best;
}

/// The edge between vertices 0 and 1, seen from a cell.
template <class Metric>
typename FanMerge<Metric>::Seed seed_of(const TetMesh& mesh, CellHandle c) {
  const Cell& cell = mesh.cell(c);
  const auto corner = [&](std::size_t v) { return static_cast<std::size_t>(cell.corner(V(v))); };
  return {c, static_cast<std::uint8_t>(kEdgeOfCorners[corner(0)][corner(1)]), 0, 0};
}

template <class Metric>
class FanMergeMetrics : public testing::Test {};
using AllMetrics = testing::Types<VolumeLength, MinSine2, MinDihedral>;
TYPED_TEST_SUITE(FanMergeMetrics, AllMetrics);

TYPED_TEST(FanMergeMetrics, FindsTheBestOfAllRowsAndTriangulations) {
  const TypeParam metric;
  using Op = FanMerge<TypeParam>;
  Engine engine(1);
  int accepted = 0, refused = 0, parts = 0;
  for (int trial = 0; trial < 4500; ++trial) {
    const std::size_t k = 2 + static_cast<std::size_t>(trial) % 6;
    const TetMesh mesh = fan(k, uniform(engine, 0.6, 3.5), engine);
    const std::size_t at = engine() % k;
    const auto quality = qualities(mesh, metric);
    const Op op{metric, quality};
    const auto plan = op.evaluate(mesh, seed_of<TypeParam>(mesh, C(at)));
    const double best = brute_force(mesh, k, at, metric);
    if (!plan) {
      ++refused;
      EXPECT_LE(best, quality[at] + 1e-12 * std::abs(quality[at]));
      continue;
    }
    ++accepted;
    parts += plan->n_removed < k ? 1 : 0;
    EXPECT_NEAR(plan->new_worst, best, 1e-12 * std::abs(best));
    cavity_of(op, mesh, *plan);
  }
  EXPECT_GT(accepted, 60);
  EXPECT_GT(refused, 150);
  EXPECT_GT(parts, 30) << "only whole fans were merged";
}

/// A tenth of the true values, so that many more merges count as better.
template <class Metric>
std::vector<double> lowered(const TetMesh& mesh, const Metric& metric) {
  std::vector<double> quality = qualities(mesh, metric);
  for (double& q : quality) q *= 0.1;
  return quality;
}

TYPED_TEST(FanMergeMetrics, MergesKeepTheMeshWhole) {
  const TypeParam metric;
  using Op = FanMerge<TypeParam>;
  int accepted = 0;
  for (std::uint64_t s = 1; s <= 12; ++s) {
    TetMesh mesh = integer_box(4, 0.24, s);
    const auto boundary = boundary_of(mesh);
    const Int128 volume = exact_volume6(mesh);
    auto quality = lowered(mesh, metric);
    for (std::size_t i = 0; i < 384; ++i) {
      for (std::uint8_t e = 0; e < 6 && !mesh.is_deleted(C(i)); ++e) {
        const double worst = *std::min_element(quality.begin(), quality.end());
        const Op op{metric, quality};
        const auto ends = kEdgeCorners[e];
        const VertexHandle a = mesh.cell(C(i)).v[ends[0]];
        const VertexHandle b = mesh.cell(C(i)).v[ends[1]];
        if (!apply(op, mesh, {C(i), e, 0, 0})) continue;
        ++accepted;
        ASSERT_EQ(check(mesh), Ok);
        EXPECT_GT(ring_size(mesh, a, b), 0U) << "the edge is to stay";
        EXPECT_TRUE(exact_volume6(mesh) == volume);
        EXPECT_TRUE(boundary_of(mesh) == boundary);
        EXPECT_GE(worst_quality(mesh, metric), worst);
        quality = lowered(mesh, metric);
      }
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST(FanMerge, ThinFanOnTheSurfaceBecomesOneCellThere) {
  Engine engine(3);
  int done = 0;
  for (int trial = 0; trial < 100; ++trial) {
    TetMesh mesh = fan(4, 1.2, engine);
    const double before = volume(mesh);
    const auto boundary = boundary_of(mesh);
    const std::vector<double> quality(mesh.n_cells(), 1e-6);
    if (!apply(FanMerge<MinDihedral>{{}, quality}, mesh, seed_of<MinDihedral>(mesh, C(1)))) continue;
    if (ring_size(mesh, V(0), V(1)) != 1) continue;
    ++done;
    EXPECT_EQ(mesh.n_logical_cells(), 7U);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_NEAR(volume(mesh), before, 1e-12);
    EXPECT_TRUE(boundary_of(mesh) == boundary);
  }
  EXPECT_GT(done, 20);
}

TEST(FanMerge, RowsEndAtInterfacesAndLabelledFaces) {
  Engine engine(7);
  int accepted = 0;
  for (int trial = 0; trial < 200; ++trial) {
    for (const bool labelled : {false, true}) {
      TetMesh mesh = random_spindle(8, engine);
      // Cells 0 … 3 are one side, 4 … 7 the other; the faces between them hold the vertices 2 and 6.
      if (labelled) {
        mesh.labels().faces.set({V(0), V(1), V(2)}, 5);
        mesh.labels().faces.set({V(0), V(1), V(6)}, 5);
      } else {
        for (std::size_t i = 0; i < 8; ++i) mesh.set_region(C(i), i < 4 ? 1 : 2);
      }
      const std::vector<double> quality(mesh.n_cells(), 1e-9);
      const FanMerge<VolumeLength> op{{}, quality};
      const CellHandle c(engine() % 8);
      const auto plan = op.evaluate(mesh, seed_of<VolumeLength>(mesh, c));
      if (!plan) continue;
      ++accepted;
      Scope scope;
      op.scope(mesh, plan->seed, scope);
      EXPECT_LE(scope.size(), 4U);
      for (CellHandle d : scope) EXPECT_EQ(d.idx() / 4, c.idx() / 4);
      ASSERT_TRUE(apply(op, mesh, seed_of<VolumeLength>(mesh, c)));
      EXPECT_EQ(check(mesh), Ok);
      Star star;
      EXPECT_TRUE(mesh.has_face(V(0), V(1), V(2), star));
      EXPECT_TRUE(mesh.has_face(V(0), V(1), V(6), star));
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST(FanMerge, NothingIsGainedNoPlan) {
  const TetMesh mesh = jittered(3, 0.2, 1);
  const std::vector<double> quality(mesh.n_cells(), 1.0);  // no cell is better
  for (CellHandle c : mesh.cells())
    for (std::uint8_t e = 0; e < 6; ++e)
      EXPECT_FALSE((FanMerge<VolumeLength>{{}, quality}.evaluate(mesh, {c, e, 0, 0})));
}

}  // namespace
}  // namespace hfr::test
