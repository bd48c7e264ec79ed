// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Wedges.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "HalfFace/Generate.hh"
#include "Quality/Metrics.hh"
#include "Quality/Statistics.hh"

namespace hfr::test {
namespace {

using Corners = std::array<Index, 4>;

constexpr double kPi = std::numbers::pi;

/// Cells round the edge from (0, 0, -1) to (0, 0, 1), closed, with outer vertices at these degrees about it.
TetMesh wheel(const std::vector<double>& degrees) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<Corners> cells;
  const auto n = static_cast<Index>(degrees.size());
  for (Index i = 0; i < n; ++i) {
    const double turn = degrees[i] * kPi / 180;
    points.push_back({std::cos(turn), std::sin(turn), 0});
    cells.push_back({0, 1, 2 + i, 2 + (i + 1) % n});
  }
  return build(points, cells);
}

int axis_of(const TetMesh& mesh, CellHandle c) {
  for (int e = 0; e < 6; ++e) {
    const auto& ends = kEdgeCorners[static_cast<std::size_t>(e)];
    if (mesh.cell(c).v[ends[0]].idx() + mesh.cell(c).v[ends[1]].idx() == 1) return e;
  }
  return -1;
}

TEST(Wedges, InnerEdgeWithoutConstrainedFacesHasNone) {
  const TetMesh mesh = wheel({0, 72, 144, 216, 288});
  EXPECT_FALSE(wedges_at(mesh, CellHandle(2), axis_of(mesh, CellHandle(2))).has_value());
}

TEST(Wedges, RegionsShareTheTurn) {
  TetMesh mesh = wheel({0, 50, 144, 216, 288});
  mesh.set_region(CellHandle(0), 1);
  mesh.set_region(CellHandle(2), 2);
  const auto found = wedges_at(mesh, CellHandle(3), axis_of(mesh, CellHandle(3)));
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->closed);
  EXPECT_FALSE(found->whole.has_value());
  EXPECT_FALSE(found->impossible);
  double sum = 0, least = 360;
  for (const Wedge& wedge : found->wedges) {
    EXPECT_TRUE(wedge.positive);
    sum += wedge.degrees;
    least = std::min(least, wedge.degrees);
  }
  EXPECT_EQ(found->wedges.size(), 4U);
  EXPECT_NEAR(sum, 360, 1e-9);
  EXPECT_NEAR(least, 50, 1e-9);
}

TEST(Wedges, InterfacesFoldedOverOneAnotherLeaveANegativeAngle) {
  // The cell of region 1 lies between faces at 50 and 49.937 degrees.
  TetMesh mesh = wheel({50, 49.937, 144, 216, 288});
  mesh.set_region(CellHandle(0), 1);
  const auto found = wedges_at(mesh, CellHandle(0), axis_of(mesh, CellHandle(0)));
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->impossible);
  double least = 360;
  for (const Wedge& wedge : found->wedges) least = std::min(least, wedge.degrees);
  EXPECT_NEAR(least, -0.063, 1e-9);
  const Statistics s = statistics(mesh);
  EXPECT_NEAR(s.interface_ceiling.degrees, -0.063, 1e-9);
  EXPECT_GT(s.surface_ceiling.degrees, 1);
  EXPECT_NEAR(s.angle_ceiling.degrees, -0.063, 1e-9);
}

TEST(Wedges, TheSmallestAngleIsAtMostThatOfTheOneCellOrHalfOfTheWedge) {
  // Labelled faces on both sides of one cell of a wheel: a narrow one, and a wide one.
  for (const double degrees : {40.0, 130.0}) {
    TetMesh mesh = wheel({0, degrees, 200, 280});
    const CellHandle c(0);
    const int axis = axis_of(mesh, c);
    const auto& opposite = kEdgeOpposite[static_cast<std::size_t>(axis)];
    for (const std::uint8_t corner : {opposite[0], opposite[1]})
      mesh.labels().faces.set(mesh.halfface_vertices(halfface_of(c, corner)), 1);
    const auto found = wedges_at(mesh, c, axis);
    ASSERT_TRUE(found.has_value());
    const auto& ends = kEdgeCorners[static_cast<std::size_t>(axis)];
    const auto& v = mesh.cell(c).v;
    double alone = 0;
    for (const Wedge& wedge : found->wedges) {
      if (std::abs(wedge.degrees - degrees) > 1e-6) continue;
      const double ceiling = wedge_ceiling(mesh, v[ends[0]], v[ends[1]], wedge);
      alone = report_value(Metric::kMinDihedral, MinDihedral{}(mesh.point(v[0]), mesh.point(v[1]),
                                                               mesh.point(v[2]), mesh.point(v[3])));
      EXPECT_NEAR(ceiling, std::max(alone, 0.5 * degrees), 1e-9);
      EXPECT_LE(statistics(mesh).angle_ceiling.degrees, ceiling + 1e-9);
    }
    EXPECT_GT(alone, 0) << "the wedge was not found";
  }
}

TEST(Wedges, InvertedCellsBetweenFacesThatAreNotFoldedProveNothing) {
  // Region 1 has the wedge from 0 to 90 degrees, in which one of two cells is inverted.
  TetMesh mesh = wheel({0, 120, 90, 180, 270});
  mesh.set_region(CellHandle(0), 1);
  mesh.set_region(CellHandle(1), 1);
  const auto found = wedges_at(mesh, CellHandle(0), axis_of(mesh, CellHandle(0)));
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(found->impossible);
  ASSERT_EQ(found->wedges.size(), 2U);
  double least = 360;
  for (const Wedge& wedge : found->wedges) least = std::min(least, wedge.degrees);
  EXPECT_NEAR(least, 90, 1e-9);
}

TEST(Wedges, FacesThatLieOnOneAnotherLeaveNothing) {
  TetMesh mesh = wheel({50, 50, 144, 216, 288});
  mesh.set_region(CellHandle(0), 1);
  const auto found = wedges_at(mesh, CellHandle(0), axis_of(mesh, CellHandle(0)));
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->impossible);
  EXPECT_NEAR(statistics(mesh).interface_ceiling.degrees, 0, 1e-9);
}

TEST(Wedges, LabelledFacesInsideCountAsWell) {
  TetMesh mesh = wheel({0, 12, 144, 216, 288});
  for (const Index outer : {2U, 3U})
    mesh.labels().faces.set({VertexHandle(0), VertexHandle(1), VertexHandle(outer)}, 5);
  EXPECT_NEAR(statistics(mesh).interface_ceiling.degrees, 12, 1e-9);
}

TEST(Wedges, EdgeOfTheBoundaryHasTheWholeToo) {
  TetMesh mesh = build({{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}},
                       std::vector<Corners>{{0, 1, 2, 3}, {0, 1, 3, 4}});
  mesh.set_region(CellHandle(1), 1);
  for (const CellHandle c : {CellHandle(0), CellHandle(1)}) {
    const auto found = wedges_at(mesh, c, axis_of(mesh, c));
    ASSERT_TRUE(found.has_value());
    ASSERT_EQ(found->wedges.size(), 2U);
    EXPECT_NEAR(found->wedges[0].degrees, 90, 1e-12);
    EXPECT_NEAR(found->wedges[1].degrees, 90, 1e-12);
    ASSERT_TRUE(found->whole.has_value());
    EXPECT_NEAR(found->whole->degrees, 180, 1e-12);
    EXPECT_FALSE(found->impossible);
  }
  // The face between them is folded out through the boundary.
  mesh.set_point(VertexHandle(3), {-1, -0.1, 0});
  const auto folded = wedges_at(mesh, CellHandle(0), axis_of(mesh, CellHandle(0)));
  ASSERT_TRUE(folded.has_value());
  EXPECT_TRUE(folded->impossible);
}

}  // namespace
}  // namespace hfr::test
