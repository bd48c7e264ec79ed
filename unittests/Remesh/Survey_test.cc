// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/Survey.hh"

#include <gtest/gtest.h>

#include "HalfFace/Reorder.hh"
#include "Quality/CellQuality.hh"
#include "Remesh/DamagedMeshes.hh"
#include "Remesh/Meshes.hh"
#include "Remesh/Standing.hh"

namespace hfr::test {
namespace {

TEST(Survey, SmallestDihedralIsThatOfTheWorstCell) {
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

TEST(Survey, WorstOfInvertedCellsDoesNotDependOnThreadsOrOrder) {
  std::vector<TetMesh> meshes = {parts_at_vertices(), tangle_of_parts(), eleven_cells(), inverted_and_flat()};
  Engine engine(1);
  for (int i = 0; i < 60; ++i) {
    meshes.push_back(built(generate::box({3, 3, 3})));
    for (VertexHandle v : meshes.back().vertices()) meshes.back().set_point(v, random_point(engine, -1, 1));
  }
  std::size_t n_sines_above = 0;
  for (const TetMesh& mesh : meshes) {
    double worst = std::numeric_limits<double>::infinity();
    for (CellHandle c : mesh.cells()) {
      worst = std::min(worst, quality(mesh, c, MinDihedral{}));
      n_sines_above += quality(mesh, c, MinSine2{}) > quality(mesh, c, MinDihedral{}) ? 1 : 0;
    }
    for (const int threads : {1, 2, 3, 5, 16}) EXPECT_EQ(survey(mesh, {threads, 0}).worst, worst);
  }
  EXPECT_GT(n_sines_above, 20U) << "the generator no longer makes cells whose smallest sine tells nothing";
}

/// All that a look at a mesh finds, of the cells that count.
std::vector<double> findings(const TetMesh& mesh, int threads, const KnownValues& known,
                             const std::function<bool(CellHandle)>& counts) {
  const par::Policy policy{threads, 0};
  const std::array<double, 4> degrees = {40, 0.001, 15, 5};
  const Survey found = survey(mesh, policy, known, counts);
  const AngleTally tally = tally_below(mesh, degrees, policy, known, counts);
  std::vector<double> all = {found.worst, static_cast<double>(found.n_invalid), tally.worst};
  for (const std::size_t n : tally.n_below) all.push_back(static_cast<double>(n));
  for (const double angle : degrees) {
    for (CellHandle c : cells_below(mesh, angle, policy, known)) all.push_back(c.idx());
    for (CellHandle c : worst_cells_below(mesh, angle, 7, policy, {}, known)) all.push_back(c.idx());
  }
  for (CellHandle c : invalid_cells(mesh, policy, known)) all.push_back(c.idx());
  const Standing standing = standing_of(mesh, survey(mesh, policy, known), policy, known);
  all.push_back(standing.overlap);
  all.push_back(static_cast<double>(standing.n_flat));
  return all;
}

TEST(Survey, ValuesThatAreKnownChangeNothing) {
  std::vector<TetMesh> meshes = {jittered(5, 0.2, 1),    jittered(5, 0.6, 1),
                                 parts_at_vertices(),    inverted_and_flat(),
                                 flat_and_overlapping(), built(generate::box({3, 3, 3}))};
  Engine engine(1);
  for (int i = 0; i < 30; ++i) {
    meshes.push_back(built(generate::box({3, 3, 3})));
    for (VertexHandle v : meshes.back().vertices()) meshes.back().set_point(v, random_point(engine, -1, 1));
  }
  for (TetMesh& mesh : meshes) {
    for (std::size_t c = 3; c < mesh.n_cells(); c += 7) mesh.delete_cell(CellHandle(c));
    Workspace work;
    work.attach(mesh, {});
    EXPECT_TRUE(known_values(work).sines.empty() && known_values(work).dihedrals.empty());
    for (const auto& counts :
         {std::function<bool(CellHandle)>(),
          std::function<bool(CellHandle)>([](CellHandle c) { return c.idx() % 3 != 0; })}) {
      const std::vector<double> expected = findings(mesh, 1, {}, counts);
      work.set_qualities(mesh, MinSine2{}, {});
      ASSERT_EQ(known_values(work).sines.size(), mesh.n_cells());
      for (const int threads : {1, 3})
        EXPECT_EQ(findings(mesh, threads, known_values(work), counts), expected);
      work.set_qualities(mesh, MinDihedral{}, {});
      ASSERT_EQ(known_values(work).dihedrals.size(), mesh.n_cells());
      for (const int threads : {1, 3})
        EXPECT_EQ(findings(mesh, threads, known_values(work), counts), expected);
      work.set_qualities(mesh, VolumeLength{}, {});
      EXPECT_TRUE(known_values(work).sines.empty() && known_values(work).dihedrals.empty());
    }
  }
}

/// Values of cells that others have changed are renewed, and go with the cells when garbage is collected.
TEST(Survey, KnownValuesFollowTheMesh) {
  TetMesh mesh = jittered(4, 0.3, 2);
  Workspace work;
  work.attach(mesh, {});
  work.set_qualities(mesh, MinSine2{}, {});
  Star star;
  ASSERT_TRUE(mesh.gather_star(V(31), star));
  const std::vector<CellHandle> moved(star.cells.begin(), star.cells.begin() + star.size);
  mesh.set_point(V(31), mesh.point(V(31)) + Vec3{0.3, 0.2, 0.1});
  mesh.delete_cell(moved[1]);
  const auto is_right = [&] {
    Workspace anew;
    anew.attach(mesh, {});
    anew.set_qualities(mesh, MinSine2{}, {});
    return anew.quality == work.quality;
  };
  EXPECT_FALSE(is_right());
  work.renew_qualities(mesh, moved, {});
  EXPECT_TRUE(is_right());
  for (std::size_t c = 3; c < mesh.n_cells(); c += 5)
    if (!mesh.is_deleted(C(c))) mesh.delete_cell(C(c));
  work.follow(mesh.collect_garbage());
  EXPECT_TRUE(is_right());
  EXPECT_EQ(work.star_size.size(), mesh.n_vertices());
  work.follow_order(reorder(mesh, {.curve = SpaceCurve::kHilbert, .vertices = false}).cells);
  EXPECT_TRUE(is_right());
  const std::vector<double> known = work.quality;
  work.forget_qualities();
  work.renew_qualities(mesh, {{C(0), C(1)}}, {});
  work.follow_order(std::vector<CellHandle>(mesh.n_cells(), C(0)));
  EXPECT_EQ(work.quality, known) << "of a metric that is not told apart";
}

TEST(Survey, InvalidCellsAreTheInvertedAndTheFlatOnes) {
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

}  // namespace
}  // namespace hfr::test
