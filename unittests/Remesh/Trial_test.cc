// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Trial.hh"

#include <gtest/gtest.h>

#include <vector>

#include "HalfFace/Errors.hh"
#include "IO/Hash.hh"
#include "Remesh/Beside.hh"
#include "Remesh/DamagedMeshes.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/StageBench.hh"

namespace hfr::test {
namespace {

/// Puts a vertex into the middle of a cell, whatever that does.
void cut(TetMesh& mesh, CellHandle c) {
  Cavity cavity;
  const auto v = mesh.cell(c).v;
  cavity.removed.push_back(c);
  cavity.new_vertex = 0.25 * ((mesh.point(v[0]) + mesh.point(v[1])) + (mesh.point(v[2]) + mesh.point(v[3])));
  for (std::size_t k = 0; k < 4; ++k) {
    Tet created = {v[0], v[1], v[2], v[3]};
    created[k] = Cavity::kNewVertex;
    cavity.created.push_back(created);
  }
  replace(mesh, cavity);
}

struct Bench {
  explicit Bench(TetMesh wanted) : mesh(std::move(wanted)), stage(mesh, serial()) {}
  TetMesh mesh;
  StageBench stage;
};

TEST(Trial, CellsThatRaiseNothingGoAgain) {
  Bench bench(jittered(3, 0.2, 1));
  const std::uint64_t hash = io::mesh_hash(bench.mesh);
  Trial trial(bench.stage.run, 1);
  cut(bench.mesh, C(11));
  EXPECT_FALSE(trial.settle());
  EXPECT_EQ(io::mesh_hash(bench.mesh), hash);
  EXPECT_EQ(bench.stage.run.work.quality.size(), bench.mesh.n_cells());
  ASSERT_EQ(bench.stage.control().passes().size(), 1U);
  EXPECT_EQ(bench.stage.control().passes()[0].stage, "undo");
  EXPECT_EQ(bench.stage.control().n_changes(), 0U);
}

TEST(Trial, CellsThatRaiseTheWorstStay) {
  for (const double goal : {1.0, 50.0}) {
    // Two flat cells on a triangle, which three round the edge between their tips are better than.
    Bench bench(bipyramid(0.2));
    const double before = smallest_dihedral(bench.mesh, {});
    Trial trial(bench.stage.run, goal);
    Cavity cavity;
    cavity.removed.push_back(C(0));
    cavity.removed.push_back(C(1));
    for (std::size_t i = 0; i < 3; ++i) cavity.created.push_back(Tet{V(4), V(3), V(i), V((i + 1) % 3)});
    replace(bench.mesh, cavity);
    ASSERT_EQ(check(bench.mesh), Ok);
    ASSERT_GT(smallest_dihedral(bench.mesh, {}), before + 1);
    bench.stage.run.work.attach(bench.mesh, {});
    EXPECT_TRUE(trial.settle()) << goal;
    EXPECT_EQ(bench.mesh.n_cells(), 3U);
    EXPECT_TRUE(bench.stage.control().passes().empty());
  }
}

/// A bipyramid, whose two cells at `first` become the three round the edge between its tips.
void swap_to_edge(TetMesh& mesh, std::size_t first, std::size_t first_vertex) {
  const auto corner = [&](std::size_t k) { return V(static_cast<Index>(first_vertex + k)); };
  Cavity cavity;
  for (std::size_t i = 0; i < 2; ++i) cavity.removed.push_back(C(static_cast<Index>(first + i)));
  for (std::size_t i = 0; i < 3; ++i)
    cavity.created.push_back(Tet{corner(4), corner(3), corner(i), corner((i + 1) % 3)});
  replace(mesh, cavity);
}

/// Beside plates that stay as poor as they are, so that the worst angle and the poorest hundredth say
/// nothing.
TEST(Trial, LowestGoalAtWhichTheNumberOfCellsDiffersDecides) {
  for (const std::vector<double>& goals : {std::vector<double>{60}, {22, 60}, {10, 22, 60}}) {
    const bool pays = goals.size() > 1;
    Bench bench(beside_plates(bipyramid(0.2), 1));
    const std::size_t n_before = bench.mesh.n_cells();
    Trial trial(bench.stage.run, goals);
    swap_to_edge(bench.mesh, 0, 0);
    ASSERT_EQ(check(bench.mesh), Ok);
    const std::vector<double> angles = angles_without_beside(bench.mesh);
    ASSERT_GT(angles.front(), 22);
    ASSERT_LT(angles.back(), 60);
    bench.stage.run.work.attach(bench.mesh, {});
    EXPECT_EQ(trial.settle(), pays) << goals.size();
    EXPECT_EQ(bench.mesh.n_cells(), pays ? n_before + 1 : n_before);
  }
}

/// Three cells become the two poorer ones of a bipyramid, and those of two others become three better ones.
TEST(Trial, FewerCellsBelowAHigherGoalAreNoGainWhereMoreAreBelowALowerOne) {
  const TetMesh flat = bipyramid(0.2), tall = bipyramid(0.45);
  const TetMesh three = build(std::vector<Vec3>(flat.points().begin(), flat.points().end()),
                              std::vector<Corners>{{4, 3, 0, 1}, {4, 3, 1, 2}, {4, 3, 2, 0}});
  Bench bench(beside(three, tall.points(), std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 1, 4}}, 2));
  constexpr double kLow = 22, kHigh = 44;
  const std::size_t n_before = bench.mesh.n_cells();
  ASSERT_EQ(n_below(bench.mesh, kLow, {}), 0U);
  ASSERT_EQ(n_below(bench.mesh, kHigh, {}), n_before);
  Trial trial(bench.stage.run, std::vector<double>{kLow, kHigh});
  Cavity back;
  for (Index i = 0; i < 3; ++i) back.removed.push_back(C(i));
  back.created.push_back(Tet{V(0), V(1), V(2), V(3)});
  back.created.push_back(Tet{V(0), V(2), V(1), V(4)});
  replace(bench.mesh, back);
  swap_to_edge(bench.mesh, 3, 5);
  swap_to_edge(bench.mesh, 5, 10);
  ASSERT_EQ(check(bench.mesh), Ok);
  ASSERT_EQ(bench.mesh.n_cells(), n_before + 1);
  ASSERT_EQ(n_below(bench.mesh, kLow, {}), 2U);
  ASSERT_EQ(n_below(bench.mesh, kHigh, {}), 2U);
  bench.stage.run.work.attach(bench.mesh, {});
  EXPECT_FALSE(trial.settle());
  EXPECT_EQ(bench.mesh.n_cells(), n_before);
}

TEST(Trial, AllButFlatWreathOfCellsIsNotFilledWithVerticesForNothing) {
  // 20 cells of 0.01 degrees, between nearly flat triangles, came to be 1,086 of 0.01.
  const std::vector<Vec3> points = {{-0.3758642963524042, 0.3223088122657193, -4.437802167113903e-05},
                                    {-0.39938996608727284, 0.6994696160372592, -2.2914361086932643e-05},
                                    {-0.5468404912290998, -0.024687562832799728, 0.00012117101720955859},
                                    {0.22324426919646517, 0.286188690456038, 0.00016523206772320787},
                                    {0.7288915647004475, 0.5697188360736878, -4.653668507566852e-05},
                                    {-0.328870613001855, 0.29036548836315274, -0.00015336239616952626},
                                    {-0.85065080835204, 0, -7.066735364426892e-05},
                                    {0.9779998062997349, -0.11343433281172854, 5.9123998615915576e-05},
                                    {-0.06604162134041087, -0.7469963258466472, 0.0001234705641906236},
                                    {-0.47123889061309504, -1.225920848778408, -5.0644814241745051e-05},
                                    {-0.24660940393755393, -0.5509285843706163, -0.0001611669326960631},
                                    {1.1490315321559024, 0.23191621869502016, -7.43112695178067e-05},
                                    {0.9011844176873922, -0.6459555163912415, -4.731984892481881e-06}};
  const std::vector<Corners> cells = {{1, 0, 2, 3},   {1, 0, 3, 4},    {1, 0, 4, 5},   {1, 0, 5, 6},
                                      {1, 0, 6, 2},   {4, 0, 3, 7},    {3, 0, 2, 8},   {2, 0, 6, 9},
                                      {6, 0, 5, 10},  {5, 0, 4, 11},   {12, 0, 7, 8},  {12, 0, 8, 9},
                                      {12, 0, 9, 10}, {12, 0, 10, 11}, {12, 0, 11, 7}, {8, 0, 7, 3},
                                      {9, 0, 8, 2},   {10, 0, 9, 6},   {11, 0, 10, 5}, {7, 0, 11, 4}};
  TetMesh mesh = build(points, cells);
  mesh.labels().faces.set({V(0), V(4), V(5)}, 1);
  mesh.labels().faces.set({V(10), V(5), V(11)}, 1);
  const double before = smallest_dihedral(mesh, {});
  ImproveOptions options = serial();
  options.surface.mode = SurfaceMode::kFree;
  options.raise_min_dihedral = true;
  Result result;
  try {
    result = improve(mesh, options);
  } catch (const InvalidInput& error) {
    expect_build_without_surface();
    GTEST_SKIP() << error.what();
  }
  EXPECT_LE(mesh.n_cells(), 60U);
  EXPECT_GE(smallest_dihedral(mesh, {}), before);
  EXPECT_EQ(result.after.cells, mesh.n_cells());
}

#ifdef HFR_HAS_SURFACE
TEST(Trial, ThreeCellsRoundAnEdgeThatMissTheGoalGetNoneForNothing) {
  TetMesh mesh = build({{-0.6068159774436782, 0.9095694968831153, 0.05287653361079453},
                        {0.0, 0.0, 0.6},
                        {-0.5966640257230598, 0.7212429100586403, -0.07927126960883253},
                        {-0.742617650014755, 0.7299999828839485, 0.06885216129554103},
                        {0.6355767638896507, -0.8643702763215229, -0.006821828929519741},
                        {0.0, 0.0, -0.6},
                        {0.5080599606382475, -0.864709380871403, -0.012637358802220347}},
                       std::vector<Corners>{{5, 1, 0, 2}, {5, 1, 6, 4}, {5, 1, 2, 3}});
  const double worst = smallest_dihedral(mesh, {});
  ASSERT_EQ(n_below(mesh, worst + kLeastRise, {}), 3U);
  ImproveOptions options = serial();
  options.min_dihedral = 15;
  options.surface.mode = SurfaceMode::kFree;
  options.ops = Ops::kEdge | Ops::kInsert;
  improve(mesh, options);
  // One of them is held where it is: vertices are for the two others.
  EXPECT_TRUE(mesh.n_cells() == 3 || n_below(mesh, worst + 1, {}) < 2) << mesh.n_cells();
  EXPECT_LE(mesh.n_cells(), 6U);
}
#endif

#ifdef HFR_HAS_SURFACE
TEST(Trial, MeshThatKeepsAnInvertedCellGetsNoPoorCellsForNothing) {
  TetMesh mesh = glued_with_an_inverted_cell();
  const std::size_t n_cells = mesh.n_cells(), n_poor = n_below(mesh, 20, {});
  ASSERT_EQ(invalid_cells(mesh, {}).size(), 1U);
  ASSERT_LT(n_poor, n_cells / 4);
  ImproveOptions options = serial();
  options.surface.mode = SurfaceMode::kFree;
  improve(mesh, options);
  EXPECT_TRUE(invalid_cells(mesh, {}).empty() || mesh.n_cells() <= n_cells || n_below(mesh, 20, {}) < n_poor)
      << mesh.n_cells() << " cells";
}
#endif

}  // namespace
}  // namespace hfr::test
