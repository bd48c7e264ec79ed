// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceUnfold.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "HalfFace/Check.hh"
#include "Remesh/Improve.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

SurfaceOptions within(double hausdorff) {
  SurfaceOptions options;
  options.mode = SurfaceMode::kFree;
  options.hausdorff = hausdorff;
  return options;
}

TetMesh wrung(double degrees) { return built(generate::cylinder(6, 16, 1, 2, 0, degrees)); }

/// Triangles of the cylinder's side that look at its axis.
std::size_t n_inwards(const TetMesh& mesh) {
  std::size_t n = 0;
  for (const Triangle& t : surface_triangles(mesh)) {
    const Vec3 middle = (1.0 / 3.0) * (t[0] + t[1] + t[2]);
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    if (std::abs(normal.z) > 0.9 * norm(normal)) continue;  // one of the ends
    if (middle.x * normal.x + middle.y * normal.y < 0) ++n;
  }
  return n;
}

TEST(SurfaceUnfold, FindsAllOfAFoldThatIsWiderThanTheRingsRoundAFace) {
  for (double degrees : {75.0, 90.0, 110.0}) {
    TetMesh mesh = wrung(degrees);
    const std::size_t folded = n_inwards(mesh);
    ASSERT_GT(folded, 80U) << degrees;
    const SurfaceUnfolding done = unfold_surface(mesh, within(1e-9));
    EXPECT_GE(done.n_folded, folded) << degrees;
    EXPECT_LE(done.n_folded, folded + 8) << degrees;
  }
}

TEST(SurfaceUnfold, SpreadsAWideFoldUntilNothingLooksInwards) {
  for (double degrees : {65.0, 75.0, 90.0}) {
    const TetMesh folded = wrung(degrees);
    TetMesh mesh = folded;
    const SurfaceUnfolding done = unfold_surface(mesh, within(0.04));
    EXPECT_GT(done.n_moved, 0U) << degrees;
    EXPECT_EQ(done.n_left, 0U) << degrees;
    EXPECT_EQ(n_inwards(mesh), 0U) << degrees;
    EXPECT_EQ(done.needs, 0) << degrees;
    EXPECT_LE(done.distance, 0.8 * 0.04);
    const double measured =
        surface_distance(surface_triangles(folded), surface_triangles(mesh), 0.05).hausdorff();
    EXPECT_LE(measured, 0.04) << degrees;
    for (VertexHandle v : folded.vertices()) {
      const Vec3 p = folded.point(v);
      const bool on_rim = (p.z == 0 || p.z == 2) && std::hypot(p.x, p.y) > 0.999;
      if (on_rim) {
        EXPECT_EQ(mesh.point(v), p);
      }
    }
  }
}

TEST(SurfaceUnfold, LeavesAFoldThatTheDistanceDoesNotAllowAsItIsAndSaysWhichWould) {
  const TetMesh folded = wrung(90);
  TetMesh mesh = folded;
  const SurfaceUnfolding done = unfold_surface(mesh, within(0.005));
  EXPECT_EQ(done.n_moved, 0U);
  EXPECT_EQ(done.n_left, done.n_folded);
  EXPECT_TRUE(std::ranges::equal(mesh.points(), folded.points()));
  ASSERT_GT(done.needs, 0.005);
  const SurfaceUnfolding again = unfold_surface(mesh, within(1.001 * done.needs));
  EXPECT_GT(again.n_moved, 0U);
  EXPECT_EQ(again.n_left, 0U);
  EXPECT_EQ(n_inwards(mesh), 0U);
}

TEST(SurfaceUnfold, EndsWhenToldToWithWhatFitsSoFar) {
  const TetMesh folded = wrung(90);
  std::size_t n_asked = 0;
  TetMesh whole = folded;
  unfold_surface(whole, within(0.04), {}, [&] { return ++n_asked == 0; });
  ASSERT_GT(n_asked, 5U);  // once a pass
  for (const std::size_t last : {std::size_t{1}, std::size_t{2}, n_asked / 2}) {
    TetMesh mesh = folded;
    std::size_t n = 0;
    const SurfaceUnfolding done = unfold_surface(mesh, within(0.04), {}, [&] { return ++n >= last; });
    EXPECT_LE(n, last + 2) << last;  // what comes after only asks and goes
    EXPECT_LE(done.n_left, done.n_folded) << last;
    EXPECT_LE(done.distance, 0.04) << last;
    if (done.n_left == done.n_folded) {
      EXPECT_TRUE(std::ranges::equal(mesh.points(), folded.points())) << last;
    }
  }
}

TEST(SurfaceUnfold, RunEndsWhereTheDistanceIsTooSmall) {
  // A vertex of an inverted cell made it less so for ever, ever further away: for minutes.
  TetMesh mesh = built(generate::cylinder(4, 12, 1, 2, 0, /*wring=*/120));
  ImproveOptions options;
  options.policy = {};
  options.surface.mode = SurfaceMode::kFree;
  const Result result = improve(mesh, options);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_FALSE(result.invalid_cells.empty());
  EXPECT_FALSE(result.folded_faces.empty());
  EXPECT_GT(result.surface.unfold_needs, result.surface.bound);
  EXPECT_LE(result.surface.hausdorff, result.surface.bound);
}

TEST(SurfaceUnfold, IsTheSameForAnyNumberOfThreads) {
  TetMesh one = wrung(90);
  const SurfaceUnfolding alone = unfold_surface(one, within(0.04), {.threads = 1});
  EXPECT_FALSE(std::ranges::equal(one.points(), wrung(90).points()));
  for (int threads : {2, 3, 7}) {
    TetMesh mesh = wrung(90);
    const SurfaceUnfolding done = unfold_surface(mesh, within(0.04), {.threads = threads, .serial_below = 1});
    EXPECT_EQ(done.distance, alone.distance) << threads;
    EXPECT_TRUE(std::ranges::equal(mesh.points(), one.points())) << threads;
  }
}

TEST(SurfaceUnfold, TouchesNeitherAFrozenSurfaceNorOneWithoutFolds) {
  TetMesh mesh = wrung(90);
  EXPECT_EQ(unfold_surface(mesh, SurfaceOptions{}).n_folded, 0U);
  TetMesh smooth = wrung(40);
  const SurfaceUnfolding none = unfold_surface(smooth, within(0.04));
  EXPECT_EQ(none.n_folded, 0U);
  EXPECT_EQ(none.n_moved, 0U);
  EXPECT_TRUE(std::ranges::equal(smooth.points(), wrung(40).points()));
}

}  // namespace
}  // namespace hfr::test
