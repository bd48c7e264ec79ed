// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/Needle.hh"

#include <gtest/gtest.h>

#include <algorithm>

#include "Operators/Clusters.hh"

namespace hfr::test {
namespace {

using detail::Needle;

TEST(Needle, KnowsItsShortSideTipAndUpWhateverCornerComesFirst) {
  const std::array<Vec3, 3> p = {{{0, -0.1, 0}, {0, 0.1, 0}, {5, 0, 0}}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Needle needle({p[i], p[(i + 1) % 3], p[(i + 2) % 3]});
    EXPECT_EQ(needle.middle, (Vec3{0, 0, 0}));
    EXPECT_EQ(needle.axis, (Vec3{5, 0, 0}));
    EXPECT_NEAR(needle.up.z, -1, 1e-15);  // from there the corners turn left
    EXPECT_NEAR(needle.side, 0.2, 1e-15);
    EXPECT_NEAR(needle.length, 5, 1e-15);
  }
}

TEST(Needle, UpIsWhereTheCellOfAHalfFaceLies) {
  const TetMesh mesh = jittered(3, 0.2, 1);
  for (HalfFaceHandle h : mesh.halffaces()) {
    const Needle needle(detail::points_of(mesh, h));
    const auto& v = mesh.cell(cell_of(h)).v;
    Vec3 middle{};
    for (VertexHandle w : v) middle = middle + 0.25 * mesh.point(w);
    EXPECT_GT(dot(needle.up, middle - needle.middle), 0);
    EXPECT_NEAR(norm(needle.up), 1, 1e-14);
  }
}

TEST(Needle, PlaceMakesTheAnglesAtTheShortSideAndAtTheTipAlike) {
  for (const double side : {0.1, 0.3}) {
    const std::array<Vec3, 3> p = {{{0, -side / 2, 0}, {0, side / 2, 0}, {5, 0, 0}}};
    for (const double t : {0.2, 1.0 / 3.0, 0.5}) {
      const Vec3 at = Needle(p).place(t);
      const auto angles = dihedrals(p[0], p[1], p[2], at);  // of edges 01 02 03 12 13 23
      EXPECT_GT(angles[0], 5) << t;
      EXPECT_NEAR(angles[0], angles[5], 0.12 * angles[0]) << t;
      EXPECT_NEAR(norm(Needle(p).place(t, 0.5) - at), 0.5 * std::abs(at.z), 1e-14);
    }
  }
}

TEST(Needle, RowsOfApexesLeaveMoreThanApexesThatAreShared) {
  // A band in the plane z = 0, as in docs/worst-angles.md: short sides at y = 0 and at y = length by turns.
  const double side = 0.28, length = 5.4;
  const auto near = [&](int i) { return Vec3{i * side, 0, 0}; };
  const auto across = [&](int i) { return Vec3{(i + 0.5) * side, length, 0}; };
  const auto smallest = [](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const auto angles = dihedrals(a, b, c, d);
    return *std::min_element(angles.begin(), angles.end());
  };
  const std::array<Vec3, 3> one = {near(0), near(1), across(0)};
  const std::array<Vec3, 3> next = {near(1), across(1), across(0)};
  const auto leaves = [&](double share) {  // of the cells on both, and of the one between them on their edge
    const Vec3 p = Needle(one).place(share);
    const Vec3 r = Needle(next).place(share);
    return std::min({smallest(one[0], one[1], one[2], p), smallest(next[0], next[1], next[2], r),
                     smallest(near(1), across(0), p, r)});
  };
  EXPECT_NEAR(leaves(1.0 / 3.0), 17.7, 0.2);
  // One for both, half-way.
  const Vec3 shared = Needle(one).place(0.5);
  const double both =
      std::min(smallest(one[0], one[1], one[2], shared), smallest(next[0], next[1], next[2], shared));
  EXPECT_GT(both, 12);
  EXPECT_LT(both, 13.5);
  // One for both at the third of the first.
  const Vec3 third = Needle(one).place(1.0 / 3.0);
  EXPECT_LT(smallest(next[0], next[1], next[2], third), 10);
}

TEST(Needle, TakesATriangleWithoutArea) {
  const Needle needle({{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}});
  EXPECT_EQ(needle.up, Vec3{});
  EXPECT_EQ(needle.place(0.5), needle.middle + 0.5 * needle.axis);
}

}  // namespace
}  // namespace hfr::test
