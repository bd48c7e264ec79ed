// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/SharedVolume.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "HalfFace/Generate.hh"
#include "Quality/Tets.hh"

namespace hfr::test {
namespace {

TEST(SharedVolume, CellSharesAllOfItselfWhicheverWayRoundItIs) {
  const Tet t = regular_tet();
  const double whole = volume6(t) / 6;
  EXPECT_DOUBLE_EQ(shared_volume(t, t), whole);
  EXPECT_DOUBLE_EQ(shared_volume(swapped(t), t), whole);
  EXPECT_DOUBLE_EQ(shared_volume(t, swapped(t)), whole);
}

TEST(SharedVolume, CellsThatShareAFaceOrLieApartShareNothing) {
  const Tet t = regular_tet();
  Tet mirrored = swapped(t);
  mirrored[3].z = -mirrored[3].z;
  EXPECT_EQ(shared_volume(t, mirrored), 0);
  Tet away = t;
  for (Vec3& p : away) p.x += 3;
  EXPECT_EQ(shared_volume(t, away), 0);
}

TEST(SharedVolume, CellInsideOfAnotherIsSharedAsAWhole) {
  const Tet t = regular_tet();
  Vec3 middle;
  for (Vec3 p : t) middle = middle + 0.25 * p;
  Tet small = t;
  for (Vec3& p : small) p = middle + 0.25 * (p - middle);
  EXPECT_NEAR(shared_volume(small, t), volume6(small) / 6, 1e-17);
  EXPECT_NEAR(shared_volume(t, small), volume6(small) / 6, 1e-17);
}

TEST(SharedVolume, HalfOfACellThatIsCutThroughItsMiddle) {
  const Tet t = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  // All of the corner where x <= y: half of it, by symmetry.
  const Tet half = {{{0, 0, 0}, {9, 9, 0}, {0, 18, 0}, {0, 0, 18}}};
  EXPECT_NEAR(shared_volume(t, half), 1.0 / 12, 1e-15);
}

TEST(SharedVolume, FlatCellsShareNothing) {
  const Tet t = regular_tet();
  Tet flat = t;
  flat[3] = (1.0 / 3) * (t[0] + t[1] + t[2]);
  EXPECT_EQ(shared_volume(flat, t), 0);
  EXPECT_EQ(shared_volume(t, flat), 0);
}

TEST(SharedVolumeProperty, BothOrdersAgree) {
  RandomTets random(7);
  int n_shared = 0;
  for (int i = 0; i < 3000; ++i) {
    const Tet a = random.next(), b = random.next();
    const double ab = shared_volume(a, b), ba = shared_volume(b, a);
    ASSERT_NEAR(ab, ba, 1e-14);
    ASSERT_LE(ab, (1 + 1e-12) * std::min(std::abs(volume6(a)), std::abs(volume6(b))) / 6 + 1e-17);
    n_shared += ab > 0 ? 1 : 0;
  }
  EXPECT_GT(n_shared, 1000);
}

TEST(SharedVolumeProperty, CellsOnBothSidesOfACommonFaceShareNothing) {
  RandomTets random(17);
  int n = 0;
  for (int i = 0; i < 3000; ++i) {
    Tet a = random.next();
    const Tet other = random.next();
    Tet b = a;
    b[3] = a[0] + a[1] + a[2] - 2 * a[3] + 0.1 * (other[3] - other[0]);
    if (volume6(a) * volume6(b) >= 0) continue;
    ++n;
    for (int k = 0; k < 4; ++k) {  // whichever corner the planes are taken from
      std::rotate(b.begin(), b.begin() + 1, b.end());
      std::rotate(a.begin(), a.begin() + k % 2, a.end());
      ASSERT_EQ(shared_volume(a, b), 0) << i;
      ASSERT_EQ(shared_volume(b, a), 0) << i;
    }
  }
  EXPECT_GT(n, 1000);
}

TEST(SharedVolumeProperty, PartsInTheCellsOfAMeshAddUpToTheCell) {
  const generate::Arrays box = generate::jittered_box({4, 4, 4}, 0.2, 3);
  const TetMesh mesh = build(box.points, box.cells);
  RandomTets random(11);
  for (int i = 0; i < 100; ++i) {
    const Tet t = random.next();  // in the unit cube
    double sum = 0;
    for (CellHandle c : mesh.cells()) sum += shared_volume(t, points_of(mesh, c));
    EXPECT_NEAR(sum, std::abs(volume6(t)) / 6, 1e-14);
  }
}

TEST(SharedVolumeProperty, NothingLiesBeyondAPlaneThatTheCellDoesNotReachBeyond) {
  const generate::Arrays box = generate::jittered_box({4, 4, 4}, 0.1, 3);
  const TetMesh mesh = build(box.points, box.cells);
  RandomTets random(13);
  int n_reached = 0, n_not = 0;
  for (int i = 0; i < 200; ++i) {
    const Tet t = random.next();
    for (CellHandle c : mesh.cells()) {
      const Shared shared = share(t, TetPlanes(points_of(mesh, c)));
      ASSERT_EQ(shared.volume, shared_volume(t, points_of(mesh, c)));
      for (int k = 0; k < 4; ++k) {
        const HalfFaceHandle beyond = mesh.opposite_halfface(halfface_of(c, k));
        if (!beyond.is_valid()) continue;
        ++(shared.reaches_beyond[static_cast<std::size_t>(k)] ? n_reached : n_not);
        if (!shared.reaches_beyond[static_cast<std::size_t>(k)]) {
          ASSERT_EQ(shared_volume(t, points_of(mesh, cell_of(beyond))), 0);
        }
      }
    }
  }
  EXPECT_GT(n_reached, 1000);
  EXPECT_GT(n_not, 1000);
  const Tet flat = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0}};
  for (const bool reaches : share(random.next(), TetPlanes(flat)).reaches_beyond) EXPECT_TRUE(reaches);
}

}  // namespace
}  // namespace hfr::test
