// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "Plex.hh"
#include "hfremesh/HalfFace/Check.hh"
#include "hfremesh/HalfFace/Circulators.hh"
#include "hfremesh/HalfFace/Generate.hh"
#include "hfremesh/HalfFace/Geometry.hh"
#include "hfremesh/Quality/Statistics.hh"

namespace hfr::test {
namespace {

TetMesh box() {
  const generate::Arrays arrays = generate::box({4, 4, 4});
  return build(arrays.points, arrays.cells);
}

double volume_of_all(const TetMesh& mesh) {
  double sum = 0;
  for (CellHandle c : mesh.cells()) sum += volume(mesh, c);
  return sum;
}

/// The halves of these cells are of a few shapes, as long as the longest edge of all cells at it is halved:
/// with others the angles get smaller and smaller.
TEST(PetscBisect, HalvesOfLongestEdgesKeepTheirShape) {
  TetMesh mesh = box();
  const std::size_t n = mesh.n_cells();
  const double cell = volume(mesh, CellHandle(0)), worst = statistics(mesh).min_dihedral.min;
  std::vector<double> largest(n, petsc::kKeep);
  for (std::size_t c = 0; c < n; c += 7) largest[c] = cell / 100;
  petsc::bisect(mesh, largest);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(mesh.n_cells(), 4 * n);
  EXPECT_NEAR(volume_of_all(mesh), 1, 1e-12);
  EXPECT_GT(statistics(mesh).min_dihedral.min, 0.6 * worst);
}

TEST(PetscBisect, MarkedCellsBecomeEightAtLeastAndNoneIsLarger) {
  TetMesh mesh = box();
  const double cell = volume(mesh, CellHandle(0));
  const std::vector<double> largest(mesh.n_cells(), petsc::kRefine);
  petsc::bisect(mesh, largest);
  for (CellHandle c : mesh.cells()) EXPECT_LE(volume(mesh, c), cell / 8 * (1 + 1e-9));
  EXPECT_EQ(mesh.n_cells(), 8 * largest.size());
}

TEST(PetscBisect, NothingIsHalvedThatIsSmallEnough) {
  TetMesh mesh = box();
  std::vector<double> largest(mesh.n_cells(), 1.0);
  largest[3] = petsc::kKeep;
  petsc::bisect(mesh, largest);
  EXPECT_EQ(mesh.n_cells(), largest.size());
}

}  // namespace
}  // namespace hfr::test
