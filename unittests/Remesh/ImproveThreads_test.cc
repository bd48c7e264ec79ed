// SPDX-License-Identifier: BSD-3-Clause
// The contract of DESIGN §5: the same bits for every number of threads.
#include <gtest/gtest.h>

#include <optional>

#include "IO/Hash.hh"
#include "Operators/LimitMeshes.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

template <class Make>
void expect_same_bits(const Make& make, ImproveOptions options) {
  std::optional<TetMesh> one;
  std::size_t n_passes = 0;
  for (const int threads : {1, 2, 3, 7, 16}) {
    TetMesh mesh = make();
    options.policy = {threads, /*serial_below=*/1};  // so that tiny loops really run in parallel
    const Result result = improve(mesh, options);
    EXPECT_TRUE(result.changed);
    EXPECT_EQ(check(mesh), Ok);
    if (!one) {
      one = mesh;
      n_passes = result.passes.size();
      continue;
    }
    EXPECT_TRUE(identical(*one, mesh)) << threads << " threads";
    EXPECT_EQ(io::mesh_hash(*one), io::mesh_hash(mesh)) << threads << " threads";
    EXPECT_EQ(result.passes.size(), n_passes);
  }
}

TEST(ImproveThreads, JitteredAndPartlyInvertedBoxHasTheSameBits) {
  const auto make = [] { return jittered(5, 0.5, 7); };
  ASSERT_GT(n_inverted(make()), 10U);
  expect_same_bits(make, serial());
}

TEST(ImproveThreads, CavityHasTheSameBits) {
  expect_same_bits([] { return small_cavity(7); }, serial());
}

TEST(ImproveThreads, VerticesOfMoreThan256CellsHaveTheSameBits) {
  const auto make = [] {
    TetMesh mesh = built(hub(150));
    shake_inner(mesh, 0.02, 4);
    return mesh;
  };
  expect_same_bits(make, serial());
}

TEST(ImproveThreads, LabelledRegionsHaveTheSameBits) {
  expect_same_bits([] { return labelled_box(4, 0.4, 5); }, serial());
}

TEST(ImproveThreads, RoundsOfEitherKindHaveTheSameBits) {
  for (const Rounds rounds : {Rounds::kByKind, Rounds::kMixed}) {
    ImproveOptions options = serial();
    options.rounds = rounds;
    expect_same_bits([] { return small_cavity(7); }, options);
  }
}

TEST(ImproveThreads, InsertionHasTheSameBits) {
  ImproveOptions options = serial();
  options.ops = Ops::kDefault | Ops::kInsert;
  expect_same_bits([] { return jittered(5, 0.5, 8); }, options);
}

TEST(ImproveThreads, UsersMetricHasTheSameBits) {
  ImproveOptions options = serial();
  options.metric = Metric::kRadiusRatio;
  expect_same_bits([] { return jittered(5, 0.4, 9); }, options);
}

TEST(ImproveThreads, PapersPipelineHasTheSameBits) {
  ImproveOptions options = serial();
  options.compat = Compat::kJpdc2013;
  expect_same_bits([] { return small_cavity(7); }, options);
}

}  // namespace
}  // namespace hfr::test
