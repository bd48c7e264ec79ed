// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/UnfillableFaces.hh"

#include <gtest/gtest.h>

#include "HalfFace/Generate.hh"
#include "HalfFace/Meshes.hh"
#include "Quality/FoldedFaces.hh"
#include "Quality/Metrics.hh"
#include "Quality/Statistics.hh"

namespace hfr::test {
namespace {

std::vector<HalfFaceHandle> boundary(const TetMesh& mesh) {
  std::vector<HalfFaceHandle> faces;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) faces.push_back(h);
  return faces;
}

std::vector<HalfFaceHandle> unfillable(const TetMesh& mesh) { return unfillable_faces(mesh, boundary(mesh)); }

std::size_t n_not_positive(const TetMesh& mesh) {
  std::size_t n = 0;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    n += orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) <= 0 ? 1 : 0;
  }
  return n;
}

/// A jittered box cut open along the middle of what was the plane x = 0.5: cells with greater x have vertices
/// of their own there, moved by `gap` along x.
TetMesh slit_box(Index n, double gap) {
  const generate::Arrays regular = generate::box({n, n, n});
  generate::Arrays arrays = regular;
  generate::jitter_inner(arrays, 0.2, 7);
  std::vector<Index> twin(arrays.points.size(), 0);
  const auto is_inside = [](double x) { return x > 0.3 && x < 0.7; };
  for (std::size_t i = 0; i < twin.size(); ++i) {
    const Vec3 p = regular.points[i];
    if (p.x != 0.5 || !is_inside(p.y) || !is_inside(p.z)) continue;
    twin[i] = static_cast<Index>(arrays.points.size());
    arrays.points.push_back(arrays.points[i] + Vec3{gap, 0, 0});
  }
  for (auto& cell : arrays.cells) {
    const bool above =
        std::any_of(cell.begin(), cell.end(), [&](Index i) { return regular.points[i].x > 0.501; });
    if (!above) continue;
    for (Index& i : cell)
      if (twin[i] != 0) i = twin[i];
  }
  return built(arrays);
}

TEST(UnfillableFaces, NoneWhereTheBoundaryIsThatOfASolid) {
  for (std::uint64_t s = 1; s <= 5; ++s)
    EXPECT_TRUE(unfillable(built(generate::jittered_box({5, 5, 5}, 0.25, s))).empty()) << s;
  EXPECT_TRUE(unfillable(built(generate::ball(4))).empty());
  EXPECT_TRUE(unfillable(built(generate::cylinder(4, 8, 1, 2, 40))).empty());
}

TEST(UnfillableFaces, TurnedTrianglesOfFlatSidesAreProven) {
  std::size_t with_turned = 0;
  for (std::uint64_t s = 1; s <= 20; ++s) {
    const TetMesh mesh = built(generate::jittered_box({5, 5, 5}, 0.5, s));
    std::vector<HalfFaceHandle> turned;  // seen from inside, the triangles of a side turn to the left
    for (HalfFaceHandle h : boundary(mesh)) {
      const auto f = mesh.halfface_vertices(h);
      const Vec3 a = mesh.point(f[0]), b = mesh.point(f[1]), c = mesh.point(f[2]);
      for (int d = 0; d < 3; ++d)
        for (const double side : {0.0, 1.0})
          if (a[d] == side && b[d] == side && c[d] == side && (cross(b - a, c - a)[d] > 0) != (side == 0))
            turned.push_back(h);
    }
    EXPECT_EQ(unfillable_faces(mesh, turned), turned) << s;
    EXPECT_EQ(unfillable(mesh).empty(), turned.empty()) << s;
    EXPECT_EQ(unfillable_faces(mesh, boundary(mesh), {.threads = 3, .serial_below = 1}), unfillable(mesh));
    with_turned += turned.empty() ? 0 : 1;
  }
  EXPECT_GT(with_turned, 10U);
}

TEST(UnfillableFaces, TurnedTrianglesOfTiltedSidesAreProvenUpToRounding) {
  std::size_t proven = 0;
  for (std::uint64_t s = 1; s <= 10; ++s) {
    generate::Arrays arrays = generate::jittered_box({5, 5, 5}, 0.5, s);
    const bool folds = !unfillable(built(arrays)).empty();
    for (Vec3& p : arrays.points)
      p = {0.6 * p.x - 0.8 * p.y, 0.48 * p.x + 0.36 * p.y - 0.8 * p.z, 0.64 * p.x + 0.48 * p.y + 0.6 * p.z};
    const bool found = !unfillable(built(arrays)).empty();
    EXPECT_TRUE(folds || !found) << s;
    proven += found ? 1 : 0;
  }
  EXPECT_GT(proven, 4U);
}

TEST(UnfillableFaces, SidesOfASlitAreNone) {
  for (const double gap : {0.0, 0.01}) {
    const TetMesh mesh = slit_box(8, gap);
    ASSERT_EQ(n_not_positive(mesh), 0U);
    EXPECT_TRUE(unfillable(mesh).empty()) << gap;
    EXPECT_EQ(folded_faces(mesh).empty(), gap > 0);
  }
}

TEST(UnfillableFaces, FacesThatGoThroughOneAnotherButHavePositiveCellsAreNone) {
  // Two cells that share vertex 0 only; an edge of the second goes through a face of the first.
  const std::vector<Vec3> points = {{0, 0, 0},  {1, 0, 0}, {0, 1, 0},      {0.4, 0.4, 1},
                                    {1, 1, -1}, {1, 1, 2}, {1.5, 0.2, 0.1}};
  const TetMesh mesh = build(points, std::vector<Corners>{{0, 1, 2, 3}, {0, 4, 5, 6}});
  ASSERT_EQ(n_not_positive(mesh), 0U);
  ASSERT_FALSE(folded_faces(mesh).empty());
  EXPECT_TRUE(unfillable(mesh).empty());
}

TEST(UnfillableFaces, AnImmersionHasNoneHoweverItsInsideIsTangled) {
  // A bar bent round by more than a whole turn, so that its ends lie in one another. The proof is one of the
  // boundary: inner vertices do not matter.
  generate::Arrays arrays = generate::box({40, 3, 3});
  std::vector<std::uint8_t> inner(arrays.points.size(), 0);
  for (std::size_t i = 0; i < arrays.points.size(); ++i) {
    const Vec3 p = arrays.points[i];
    inner[i] = p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1 && p.z > 0 && p.z < 1 ? 1 : 0;
    const double turn = 2.3 * std::numbers::pi * p.x;
    arrays.points[i] = {(2 + p.y) * std::sin(turn), (2 + p.y) * std::cos(turn), p.z + 0.01 * p.x};
  }
  TetMesh mesh = built(arrays);
  ASSERT_EQ(n_not_positive(mesh), 0U);
  EXPECT_TRUE(unfillable(mesh).empty());
  for (std::size_t i = 0; i < inner.size(); ++i)
    if (inner[i]) mesh.set_point(VertexHandle(i), {0.1 * static_cast<double>(i % 7), 0, 0});
  ASSERT_GT(n_not_positive(mesh), 50U);
  EXPECT_TRUE(unfillable(mesh).empty());
}

TEST(UnfillableFaces, ABoxTurnedInsideOutAtACornerIsProven) {
  // The corner is pulled through the box and out on the other side: behind its faces lies the outside.
  TetMesh mesh = built(generate::box({2, 2, 2}));
  mesh.set_point(VertexHandle(0), {3, 3, 3});
  const auto proven = unfillable(mesh);
  EXPECT_FALSE(proven.empty());
  for (HalfFaceHandle h : proven) EXPECT_TRUE(mesh.is_boundary(h));
}

TEST(Statistics, SlitTakesAWholeTurnAndIsNoCeiling) {
  // The turn round the rim of a slit came to 360 degrees and a rounding, which was taken for a rounding.
  for (const Index n : {6U, 8U, 10U})
    EXPECT_GT(statistics(slit_box(n, 0.0)).surface_ceiling.degrees, 20) << n;
}

}  // namespace
}  // namespace hfr::test
