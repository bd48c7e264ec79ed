// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Pipeline.hh"

#include <gtest/gtest.h>

#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

TEST(Pipeline, SmallestDihedralIsThatOfTheWorstCell) {
  const TetMesh mesh = jittered(5, 0.2, 1);
  double smallest = 180;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    for (double angle : dihedrals(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])))
      smallest = std::min(smallest, angle);
  }
  for (const int threads : {1, 3}) EXPECT_NEAR(smallest_dihedral(mesh, {threads, 1}), smallest, 1e-9);
  EXPECT_LT(smallest_dihedral(jittered(5, 0.6, 1), {}), 0);
}

TEST(Pipeline, InvalidCellsAreTheInvertedAndTheFlatOnes) {
  TetMesh mesh = built(generate::box({3, 3, 3}));
  EXPECT_TRUE(invalid_cells(mesh, {}).empty());
  const VertexHandle inner = V((1 * 4 + 1) * 4 + 1);
  mesh.set_point(inner,
                 {0, 1.0 / 3, 1.0 / 3});  // onto its neighbour on the surface: flat cells, inverted none
  const auto flat = invalid_cells(mesh, {});
  EXPECT_FALSE(flat.empty());
  mesh.set_point(inner, {-0.2, 1.0 / 3, 1.0 / 3});
  const auto inverted = invalid_cells(mesh, {});
  EXPECT_GE(inverted.size(), n_inverted(mesh));
  EXPECT_GT(n_inverted(mesh), 0U);
  EXPECT_TRUE(std::is_sorted(inverted.begin(), inverted.end()));
  EXPECT_EQ(invalid_cells(mesh, {3, 1}), inverted);
}

TEST(Pipeline, UntangleStopsWhenNothingIsInvertedAndTouchesNothingElse) {
  TetMesh mesh = jittered(5, 0.1, 1);
  const TetMesh before = mesh;
  Workspace work;
  work.attach(mesh, {});
  ImproveOptions options = serial();
  RunControl control(options);
  untangle(mesh, work, options, control);
  EXPECT_TRUE(identical(mesh, before));
  EXPECT_TRUE(control.passes().empty());
}

}  // namespace
}  // namespace hfr::test
