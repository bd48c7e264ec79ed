// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

TEST(Jpdc2013, ThreeIterationsRemoveTheInvertedCellsOfACavity) {
  TetMesh mesh = small_cavity();
  const auto boundary = boundary_of(mesh);
  const double before = volume(mesh);
  ASSERT_GT(n_inverted(mesh), 5U);
  ImproveOptions options = serial();
  options.compat = Compat::kJpdc2013;
  const Result result = improve(mesh, options);
  EXPECT_EQ(n_inverted(mesh), 0U);
  EXPECT_TRUE(result.goal_reached);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(boundary_of(mesh) == boundary);
  EXPECT_NEAR(volume(mesh), before, 1e-12);
  expect_dense(mesh);
  // Edge → face → node → smooth, three times, in this order.
  const std::array<const char*, 4> order = {"edge", "face", "node", "smooth"};
  ASSERT_LE(result.passes.size(), 12U);
  ASSERT_GE(result.passes.size(), 4U);
  for (std::size_t i = 0; i < result.passes.size(); ++i) {
    EXPECT_EQ(result.passes[i].op, order[i % 4]);
    EXPECT_EQ(result.passes[i].iteration, static_cast<int>(i / 4) + 1);
    EXPECT_EQ(result.passes[i].stage, "jpdc2013");
    EXPECT_GE(result.passes[i].worst, result.passes[i - std::min<std::size_t>(i, 1)].worst);
  }
}

TEST(Jpdc2013, OptionsChooseOperatorsAndIterations) {
  TetMesh mesh = jittered(6, 0.3, 1);
  ImproveOptions options = serial();
  options.compat = Compat::kJpdc2013;
  options.ops = Ops::kFace | Ops::kSmooth;
  options.iterations = 2;
  const Result result = improve(mesh, options);
  ASSERT_EQ(result.passes.size(), 4U);
  EXPECT_EQ(result.passes[0].op, "face");
  EXPECT_EQ(result.passes[3].op, "smooth");
  EXPECT_EQ(result.passes[3].iteration, 2);
}

TEST(Jpdc2013, InsertionAddsVerticesOnlyWhenAllowed) {
  for (const bool insert : {false, true}) {
    TetMesh mesh = jittered(6, 0.45, 2);
    ImproveOptions options = serial();
    options.compat = Compat::kJpdc2013;
    options.ops = Ops::kEdge | Ops::kFace;
    if (insert) options.ops = options.ops | Ops::kInsert;
    const std::size_t before = mesh.n_vertices();
    improve(mesh, options);
    EXPECT_EQ(mesh.n_vertices() > before, insert);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_NEAR(volume(mesh), 1, 1e-12);
  }
}

TEST(Jpdc2013, DefaultPipelineIsNoWorseThanThePapers) {
  TetMesh papers = small_cavity();
  TetMesh ours = papers;
  ImproveOptions options = serial();
  options.compat = Compat::kJpdc2013;
  const Result theirs = improve(papers, options);
  const Result result = improve(ours, serial());
  EXPECT_GE(result.after.min_dihedral.min, theirs.after.min_dihedral.min);
}

}  // namespace
}  // namespace hfr::test
