// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Decisions.hh"

#include <gtest/gtest.h>

#include <limits>

#include "HalfFace/Generate.hh"
#include "Operators/Metrics.hh"

namespace hfr {
namespace {

/// Good, poor, inverted and flat cells, one of them deleted.
TetMesh mixed_mesh() {
  generate::Arrays box = generate::jittered_box({5, 5, 5}, 0.45, 3);
  for (Vec3& p : box.points)
    if (p.x > 0.7) p.x = 0.75;  // flat
  TetMesh mesh = build(box.points, box.cells);
  mesh.delete_cell(CellHandle(11));
  return mesh;
}

template <class Metric>
class Decisions : public testing::Test {};
using MetricsWithBlocks = testing::Types<VolumeLength, MinSine2, MinDihedral, Untangling, ScaledJacobian>;
TYPED_TEST_SUITE(Decisions, MetricsWithBlocks);

TYPED_TEST(Decisions, AreTheBitsOfTheMetricCellByCell) {
  const TetMesh mesh = mixed_mesh();
  const TypeParam metric{};
  std::size_t next = 7;  // not the first of a block
  std::size_t n_positive = 0;
  std::size_t n_not = 0;
  for_decisions(mesh, metric, next, mesh.n_cells() - 5, [&](std::size_t i, double value) {
    ASSERT_EQ(i, next++);
    const CellHandle c(i);
    if (mesh.is_deleted(c)) {
      EXPECT_EQ(value, std::numeric_limits<double>::infinity());
      return;
    }
    const auto& v = mesh.cell(c).v;
    EXPECT_EQ(value, metric(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])));
    ++(value > 0 ? n_positive : n_not);
  });
  EXPECT_EQ(next, mesh.n_cells() - 5);
  EXPECT_GT(n_positive, 100U);
  EXPECT_GT(n_not, 100U);
}

}  // namespace
}  // namespace hfr
