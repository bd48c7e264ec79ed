// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Limits.hh"

#include "Quality/FoldedFaces.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

std::size_t n_of(const std::vector<StuckCell>& cells, Limit limit) {
  return count_limits(cells)[static_cast<std::size_t>(limit)];
}

/// A roof: two cells on a wedge of the given degrees at the edge (0, 1).
TetMesh wedge(double degrees) {
  const double half = 0.5 * degrees * std::numbers::pi / 180;
  return build({{-1, 0, 0},
                {1, 0, 0},
                {0, std::sin(half), std::cos(half)},
                {0, -std::sin(half), std::cos(half)},
                {0, 0, 3}},
               std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 4, 3}, {1, 4, 2, 3}});
}

TEST(StuckCells, NoneAreBelowWhatAllMeet) {
  const TetMesh mesh = jittered(3, 0.1, 1);
  EXPECT_TRUE(stuck_cells(mesh, 5, false, {}).empty());
}

TEST(StuckCells, EveryCellBelowTheAngleIsListedOnce) {
  const TetMesh mesh = jittered(4, 0.24, 3);
  const auto stuck = stuck_cells(mesh, 30, false, {});
  std::size_t n = 0;
  for (CellHandle c : mesh.cells()) {
    const auto& v = mesh.cell(c).v;
    const double q = quality_of(mesh, v, MinDihedral{});
    n += report_value(Metric::kMinDihedral, q) < 30 ? 1 : 0;
  }
  ASSERT_GT(n, 20U);
  EXPECT_EQ(stuck.size(), n);
  EXPECT_TRUE(std::is_sorted(stuck.begin(), stuck.end(),
                             [](const StuckCell& a, const StuckCell& b) { return a.cell < b.cell; }));
  std::size_t sum = 0;
  for (std::size_t count : count_limits(stuck)) sum += count;
  EXPECT_EQ(sum, n);
}

TEST(StuckCells, NarrowWedgeOfTheSurfaceIsACeiling) {
  const auto narrow = stuck_cells(wedge(20), 25, false, {});
  ASSERT_GE(narrow.size(), 1U);
  EXPECT_EQ(narrow[0].cell, C(0));
  EXPECT_EQ(narrow[0].limit, Limit::kSurfaceCeiling);
  EXPECT_EQ(narrow[0].n_frozen_vertices, 4);
  EXPECT_NEAR(narrow[0].degrees, 20, 1e-9);
}

TEST(StuckCells, WedgeThatOneCellHasToFillIsACeilingWhereThisCellIsPoor) {
  // Surface faces (0, 1, 2) and (0, 1, 3) meet at 40 degrees, and the cell on both of them has an angle of 9
  // at its other end: two cells in the wedge would have one of at most 20.
  TetMesh mesh = wedge(40);
  mesh.set_point(V(2), {0.9, 0.6, 0.2});
  const auto stuck = stuck_cells(mesh, 25, false, {});
  for (const StuckCell& cell : stuck)
    if (cell.cell == C(0)) {
      EXPECT_EQ(cell.limit, Limit::kSurfaceCeiling);
    }
  EXPECT_EQ(n_of(stuck_cells(mesh, 15, false, {}), Limit::kSurfaceCeiling), 0U);
}

TEST(StuckCells, WedgeAtAnInterfaceIsAnInputFeature) {
  // Six cells round an edge of the octahedron's axis, one of them in a region of its own, squeezed.
  TetMesh mesh = octahedron();
  mesh.set_region(C(0), 1);
  const Cell cell = mesh.cell(C(0));
  // Bring two outer corners of cell 0 close to each other: its wedge at the edge to the third is narrow.
  mesh.set_point(cell.v[1], mesh.point(cell.v[2]) + 0.15 * (mesh.point(cell.v[1]) - mesh.point(cell.v[2])));
  const auto stuck = stuck_cells(mesh, 20, false, {});
  EXPECT_GE(n_of(stuck, Limit::kInputFeature), 1U);
  mesh.set_region(C(0), 0);
  EXPECT_EQ(n_of(stuck_cells(mesh, 20, false, {}), Limit::kInputFeature), 0U);
}

TEST(StuckCells, FoldsAreNamedBeforeAnythingElse) {
  const TetMesh mesh = jittered(5, 0.5, 2);
  const auto folded = folded_faces(mesh);
  ASSERT_FALSE(folded.empty());
  EXPECT_GT(n_of(stuck_cells(mesh, 5, true, folded), Limit::kFoldedSurface), 0U);
  EXPECT_EQ(n_of(stuck_cells(mesh, 5, true, {}), Limit::kFoldedSurface), 0U);
}

TEST(StuckCells, RunThatEndedEarlySaysBudget) {
  const TetMesh mesh = jittered(4, 0.35, 2);
  const auto done = stuck_cells(mesh, 20, false, {});
  const auto early = stuck_cells(mesh, 20, true, {});
  ASSERT_EQ(done.size(), early.size());
  EXPECT_EQ(n_of(done, Limit::kBudget), 0U);
  EXPECT_EQ(n_of(early, Limit::kBudget), n_of(done, Limit::kSearch) + n_of(done, Limit::kFrozenVertices));
  EXPECT_GT(n_of(early, Limit::kBudget), 0U);
}

}  // namespace
}  // namespace hfr::test
