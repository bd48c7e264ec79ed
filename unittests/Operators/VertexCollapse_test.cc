// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/VertexCollapse.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

static_assert(LocalOperator<VertexCollapse<VolumeLength>>);

TEST(VertexCollapse, VertexNextToItsNeighbourCollapsesOntoIt) {
  TetMesh mesh = octahedron({0.97, 0, 0});
  const auto quality = qualities(mesh, VolumeLength{});
  const std::vector<std::uint8_t> frozen = frozen_vertices(mesh);
  const double before = volume(mesh);
  const VertexCollapse<VolumeLength> op{{}, quality, frozen};
  const auto plan = op.evaluate(mesh, V(0));
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->removes_vertex);
  ASSERT_TRUE(apply(op, mesh, V(0)));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(mesh.is_deleted(V(0)));
  EXPECT_EQ(mesh.n_logical_cells(), 4U);
  EXPECT_EQ(mesh.n_logical_vertices(), 6U);
  EXPECT_NEAR(volume(mesh), before, 1e-15);
}

TEST(VertexCollapse, EveryLinkVertexIsTried) {
  Engine engine(6);
  std::set<Index> apexes;
  int accepted = 0;
  for (int trial = 0; trial < 300; ++trial) {
    TetMesh mesh = octahedron();
    for (std::size_t i = 1; i < 7; ++i)
      mesh.set_point(V(i), mesh.point(V(i)) + random_point(engine, -0.3, 0.3));
    mesh.set_point(V(0), random_point(engine, -0.6, 0.6));
    const auto quality = qualities(mesh, VolumeLength{});
    const double old_worst = *std::min_element(quality.begin(), quality.end());
    std::vector<CellHandle> star;
    for (CellHandle c : mesh.cells()) star.push_back(c);
    const double best = best_star(mesh, star, VolumeLength{});
    const auto frozen = frozen_vertices(mesh);
    const VertexCollapse<VolumeLength> op{{}, quality, frozen};
    const auto plan = op.evaluate(mesh, V(0));
    ASSERT_EQ(plan.has_value(), best > old_worst);
    if (!plan) continue;
    ++accepted;
    apexes.insert(plan->apex.idx());
    EXPECT_EQ(plan->old_worst, old_worst);
    EXPECT_EQ(plan->new_worst, best);
    EXPECT_EQ(cavity_of(op, mesh, *plan).removed_vertex, V(0));
  }
  EXPECT_GT(accepted, 50);
  EXPECT_EQ(apexes.size(), 6U) << "some link vertex is never chosen";
}

TEST(VertexCollapse, FrozenAndLabelledVerticesStay) {
  TetMesh mesh = octahedron({0.97, 0, 0});
  const auto quality = qualities(mesh, VolumeLength{});
  std::vector<std::uint8_t> frozen(mesh.n_vertices(), 0);
  const auto accepts = [&] {
    return VertexCollapse<VolumeLength>{{}, quality, frozen}.evaluate(mesh, V(0)).has_value();
  };
  ASSERT_TRUE(accepts());
  frozen[0] = 1;
  EXPECT_FALSE(accepts());
  frozen[0] = 0;
  mesh.labels().vertices.assign(mesh.n_vertices(), 0);
  mesh.labels().vertices[0] = 7;
  EXPECT_FALSE(accepts());
}

TEST(VertexCollapse, StarTooLargeToHoldIsRefused) {
  // Vertex 0 in the middle of a spindle of 150: 300 cells.
  const Index n = 150;
  std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Corners> cells;
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    points.push_back({std::cos(angle), std::sin(angle), 0});
    cells.push_back({0, 3 + i, 3 + (i + 1) % n, 1});
    cells.push_back({0, 3 + (i + 1) % n, 3 + i, 2});
  }
  const TetMesh mesh = build(points, cells);
  const std::vector<double> quality(mesh.n_cells(), -1.0);
  const std::vector<std::uint8_t> frozen(mesh.n_vertices(), 0);
  EXPECT_FALSE((VertexCollapse<VolumeLength>{{}, quality, frozen}.evaluate(mesh, V(0))));
}

}  // namespace
}  // namespace hfr::test
