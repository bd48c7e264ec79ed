// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/CellQuality.hh"

#include <gtest/gtest.h>

#include "HalfFace/Generate.hh"

namespace hfr {
namespace {

TEST(CellQuality, OfAMeshCellIsThatOfItsPoints) {
  const generate::Arrays box = generate::jittered_box({2, 2, 2}, 0.2, 1);
  TetMesh mesh = build(box.points, box.cells);
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell_vertices(c);
    const auto p = [&](std::size_t k) { return mesh.point(v[k]); };
    for (Metric metric : kMetrics)
      EXPECT_EQ(quality(mesh, c, metric), reported_quality(metric, p(0), p(1), p(2), p(3)));
    EXPECT_EQ(quality(mesh, c, VolumeLength{}), quality(Metric::kVolumeLength, p(0), p(1), p(2), p(3)));
    const CustomMetric own([](Vec3 a, Vec3 b, Vec3, Vec3) { return norm(a - b); });
    EXPECT_EQ(quality(mesh, c, own), own(p(0), p(1), p(2), p(3)));
    EXPECT_EQ(orientation(mesh, c), 1);
  }
  const auto& v = mesh.cell_vertices(CellHandle(0));
  mesh.set_point(v[0], mesh.point(v[1]));
  EXPECT_EQ(orientation(mesh, CellHandle(0)), 0);
}

}  // namespace
}  // namespace hfr
