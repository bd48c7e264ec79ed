// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/EdgeRemoval.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<EdgeRemoval<VolumeLength>>);
static_assert(LocalOperator<EdgeRemoval<MinSine2>>);

/// Best worst cell over all triangulations of the ring 2 … n+1 of a spindle.
template <class Metric>
double brute_force(const TetMesh& mesh, std::size_t n, const Metric& metric) {
  double best = -std::numeric_limits<double>::infinity();
  for (const auto& triangulation : triangulations(0, n - 1))
    best = std::max(best, worst_of_tets(mesh, cells_on(triangulation), metric));
  return best;
}

template <class Metric>
class EdgeRemovalMetrics : public testing::Test {};
using BothMetrics = testing::Types<VolumeLength, MinSine2, MinDihedral>;
TYPED_TEST_SUITE(EdgeRemovalMetrics, BothMetrics);

TYPED_TEST(EdgeRemovalMetrics, ProgrammeFindsTheBestOfAllTriangulations) {
  const TypeParam metric;
  ASSERT_EQ(triangulations(0, 7).size(), 132U);  // Catalan's number for an octagon
  Engine engine(1);
  int all_refused = 0;
  for (std::size_t n = 3; n <= 8; ++n) {
    int accepted = 0;
    int refused = 0;
    for (int trial = 0; trial < (n < 7 ? 150 : 60); ++trial) {
      const TetMesh mesh = random_spindle(n, engine, trial % 3 == 0 ? 0.6 : 0.0);
      const auto quality = qualities(mesh, metric);
      const double old_worst = *std::min_element(quality.begin(), quality.end());
      const double best = brute_force(mesh, n, metric);
      const EdgeRemoval<TypeParam> op{metric, quality};
      const auto plan = op.evaluate(mesh, edge_between(mesh, V(0), V(1)));
      if (!plan) {
        ++refused;
        EXPECT_LE(best, old_worst + 1e-12 * std::abs(old_worst));
        continue;
      }
      ++accepted;
      EXPECT_EQ(plan->old_worst, old_worst);
      EXPECT_NEAR(plan->new_worst, best, 1e-12 * std::abs(best)) << "ring of " << n;
      cavity_of(op, mesh, *plan);
    }
    EXPECT_GT(accepted, 10) << "ring of " << n;
    all_refused += refused;
  }
  EXPECT_GT(all_refused, 50);
}

TEST(EdgeRemoval, CreatedCellsFillTheSameVolumeExactly) {
  Engine engine(2);
  int accepted = 0;
  for (int trial = 0; trial < 300; ++trial) {
    TetMesh mesh = random_spindle(3 + static_cast<std::size_t>(trial) % 10, engine, trial % 2 ? 0.0 : 0.5);
    for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
      const Vec3 p = 65536.0 * mesh.point(V(i));
      mesh.set_point(V(i), {std::round(p.x), std::round(p.y), std::round(p.z)});
    }
    const Int128 before = exact_volume6(mesh);
    const auto boundary = boundary_of(mesh);
    const auto quality = qualities(mesh, VolumeLength{});
    if (!apply(EdgeRemoval<VolumeLength>{{}, quality}, mesh, edge_between(mesh, V(0), V(1)))) continue;
    ++accepted;
    EXPECT_TRUE(exact_volume6(mesh) == before);
    EXPECT_TRUE(boundary_of(mesh) == boundary);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_EQ(ring_size(mesh, V(0), V(1)), 0U);
  }
  EXPECT_GT(accepted, 60) << "the generator no longer makes removable edges";
}

/// A flat wheel of n cells whose axis stands beside ring vertex 2.
TetMesh wheel(std::size_t n) {
  std::vector<Vec3> points = {{0.97, 0, -0.05}, {0.97, 0, 0.05}};
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  return spindle(points);
}

TEST(EdgeRemoval, EverySeedOfTheRingGivesTheSameWorst) {
  TetMesh mesh = wheel(7);
  for (const std::size_t i : {0, 1}) mesh.set_point(V(i), {1.02, 0.1, mesh.point(V(i)).z});
  const auto quality = qualities(mesh, VolumeLength{});
  const EdgeRemoval<VolumeLength> op{{}, quality};
  std::set<double> worsts;
  for (CellHandle c : mesh.cells()) {
    const Cell& cell = mesh.cell(c);
    const int edge = kEdgeOfCorners[static_cast<std::size_t>(cell.corner(V(0)))]
                                   [static_cast<std::size_t>(cell.corner(V(1)))];
    const EdgeHandle seed(6 * c.idx() + static_cast<Index>(edge));
    const auto plan = op.evaluate(mesh, seed);
    ASSERT_TRUE(plan);
    EXPECT_EQ(op.identity(mesh, seed), (Tet{V(0), V(1), VertexHandle(), VertexHandle()}));
    worsts.insert(std::round(plan->new_worst * 1e12));
    const Cavity cavity = cavity_of(op, mesh, *plan);
    EXPECT_EQ(std::set<CellHandle>(cavity.removed.begin(), cavity.removed.end()).size(), 7U);
  }
  EXPECT_EQ(worsts.size(), 1U);
}

TEST(EdgeRemoval, RingOf32IsSearchedAndOf33LeftAlone) {
  for (const std::size_t n : {32, 33}) {
    TetMesh mesh = wheel(n);
    // With the axis out of the ring two cells are inverted, and any triangulation of it is better.
    mesh.set_point(V(0), {1.02, 0, -0.05});
    mesh.set_point(V(1), {1.02, 0, 0.05});
    const auto quality = qualities(mesh, VolumeLength{});
    const EdgeRemoval<VolumeLength> op{{}, quality};
    const auto plan = op.evaluate(mesh, edge_between(mesh, V(0), V(1)));
    EXPECT_EQ(plan.has_value(), n == 32);
    if (!plan) continue;
    EXPECT_EQ(cavity_of(op, mesh, *plan).created.size(), 60U);
  }
}

TEST(EdgeRemoval, BoundaryEdgesAreRefused) {
  const TetMesh mesh = jittered(3, 0.3, 4);
  const std::vector<double> quality(mesh.n_cells(), -1.0);  // anything would be an improvement
  const EdgeRemoval<VolumeLength> op{{}, quality};
  int boundary = 0;
  for (EdgeHandle e : mesh.boundary_edges()) {
    ++boundary;
    EXPECT_FALSE(op.evaluate(mesh, e));
  }
  EXPECT_EQ(boundary, 6 * 18 * 3 / 2);  // three edges a triangle, each of two
}

}  // namespace
}  // namespace hfr::test
