// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Coverage.hh"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "HalfFace/Generate.hh"
#include "Quality/FoldedFaces.hh"
#include "Quality/Metrics.hh"
#include "Quality/RoundAxle.hh"

namespace hfr::test {
namespace {

/// Points turned about two axes by so many degrees.
void turn(std::vector<Vec3>& points, double degrees) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  for (Vec3& p : points) {
    p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    p = {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
  }
}

TetMesh turned_round_axle(int n, double degrees, bool closed, double turned) {
  std::vector<Vec3> points = points_round_axle(n, degrees, closed);
  turn(points, turned);
  return round_axle(n, points);
}

bool at_centre(VertexHandle v) { return v.idx() == 0; }

bool covers_twice_at_centre(const TetMesh& mesh) {
  const bool twice = covers_twice(mesh, {}, at_centre);
  EXPECT_EQ(covers_twice(mesh, {3}, at_centre), twice);
  EXPECT_FALSE(covers_twice(mesh, {}, [](VertexHandle) { return false; }));
  return twice;
}

bool has_inverted(const TetMesh& mesh) {
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    if (orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) <= 0) return true;
  }
  return false;
}

/// A wedge is left out between the last and the first cells: no face of the vertex lies on another one.
TEST(Coverage, CellsRoundABoundaryEdgeCoverTwiceFromAWholeTurnOn) {
  for (double turned = 0; turned < 360; turned += 17) {
    for (const double degrees : {90.0, 179.0, 181.0, 300.0, 359.0})
      for (const int n : {3, 5, 9, 70})
        EXPECT_FALSE(covers_twice_at_centre(turned_round_axle(n, degrees, false, turned)))
            << degrees << " " << n;
    for (const double degrees : {361.0, 450.0, 520.0, 700.0})
      for (const int n : {5, 9, 70}) {
        const TetMesh mesh = turned_round_axle(n, degrees, false, turned);
        EXPECT_FALSE(has_inverted(mesh));
        EXPECT_TRUE(folded_faces(mesh, {}, at_centre).empty());
        EXPECT_TRUE(covers_twice_at_centre(mesh)) << degrees << " " << n << " turned by " << turned;
        EXPECT_TRUE(is_wound_at(mesh, std::array{VertexHandle(0)}));
      }
  }
}

TEST(Coverage, CellsRoundAnInnerEdgeCoverTwiceFromTwoTurnsOn) {
  for (double turned = 0; turned < 360; turned += 17) {
    for (const int n : {3, 4, 5, 9, 70})
      EXPECT_FALSE(covers_twice_at_centre(turned_round_axle(n, 360, true, turned))) << n;
    for (const int n : {5, 9, 70}) {
      const TetMesh mesh = turned_round_axle(n, 720, true, turned);
      EXPECT_FALSE(has_inverted(mesh));
      EXPECT_TRUE(covers_twice_at_centre(mesh)) << n << " turned by " << turned;
    }
  }
}

/// What goes back over an inverted cell is no turn.
TEST(Coverage, InvertedCellsTurnBack) {
  std::vector<Vec3> points = points_round_axle(9, 340, false);
  EXPECT_FALSE(is_wound_at(round_axle(9, points), std::array{VertexHandle(0)}));
  const auto at = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  points[points.size() - 2] = at(375);  // and back to 340
  EXPECT_FALSE(is_wound_at(round_axle(9, points), std::array{VertexHandle(0)}));
  points.back() = at(380);
  EXPECT_TRUE(is_wound_at(round_axle(9, points), std::array{VertexHandle(0)}));
}

TEST(Coverage, SolidsCoverOnce) {
  for (std::uint64_t seed = 1; seed < 9; ++seed) {
    const auto box = generate::jittered_box({4, 4, 4}, 0.2, seed);
    EXPECT_FALSE(covers_twice(build(box.points, box.cells)));
  }
  const auto ball = generate::ball(4);
  EXPECT_FALSE(covers_twice(build(ball.points, ball.cells)));
  const auto cylinder = generate::cylinder(3, 6, 1, 2, 40);
  EXPECT_FALSE(covers_twice(build(cylinder.points, cylinder.cells)));
}

/// With the axle along the direction that the pass over the cells counts by, no cell there can tell.
TEST(Coverage, CellsOfAnEdgeAlongTheDirectionAreWalkedRound) {
  const Vec3 axle{0.8507350102, 0.4415211327, 0.2851530273};
  const Vec3 x = cross(axle, {0, 0, 1}), y = cross(axle, x);
  const auto along = [&](double degrees) {
    std::vector<Vec3> points = points_round_axle(7, degrees, false);
    for (Vec3& p : points) p = p.x * x + p.y * y + p.z * axle;
    return round_axle(7, points);
  };
  EXPECT_FALSE(has_inverted(along(350)));
  EXPECT_FALSE(covers_twice_at_centre(along(350)));
  EXPECT_TRUE(covers_twice_at_centre(along(400)));
}

TEST(Coverage, CellsThatAreNotPositiveCount) {
  const auto box = generate::jittered_box({4, 4, 4}, 0.9, 1);
  const TetMesh mesh = build(box.points, box.cells);
  ASSERT_TRUE(has_inverted(mesh));
  EXPECT_TRUE(covers_twice(mesh));
}

}  // namespace
}  // namespace hfr::test
