// SPDX-License-Identifier: BSD-3-Clause
// Random sequences of operators over tangled meshes, with fixed seeds.
#include <gtest/gtest.h>

#include "Remesh/Meshes.hh"
#include "Remesh/Survey.hh"

namespace hfr::test {
namespace {

constexpr std::array<Smoother, 4> kSmoothers = {Smoother::kNewton, Smoother::kCandidates,
                                                Smoother::kLaplacian, Smoother::kTaubin};

TetMesh tangled(std::uint64_t seed) {
  const double jitter = 0.3 + 0.1 * static_cast<double>(seed % 5);
  return seed % 3 == 0 ? labelled_box(4, jitter, seed) : jittered(4, jitter, seed);
}

class Soak : public testing::TestWithParam<std::uint64_t> {};

TEST_P(Soak, RandomOperatorsKeepAMeshWhole) {
  Engine engine(GetParam());
  TetMesh mesh = tangled(GetParam());
  const auto boundary = boundary_of(mesh);
  const auto frozen = frozen_places(mesh);
  const auto volumes = region_volumes(mesh);
  const auto faces = places_of(mesh, mesh.labels().faces);
  const auto edges = places_of(mesh, mesh.labels().edges);
  std::size_t winners = 0;
  for (int step = 0; step < 5; ++step) {
    const std::size_t inverted = invalid_cells(mesh, {}).size();
    ImproveOptions options = serial();
    options.ops = static_cast<Ops>(1 + engine() % 63);
    options.smoother = kSmoothers[engine() % kSmoothers.size()];
    options.metric = kMetrics[engine() % kMetrics.size()];
    options.compat = engine() % 4 == 0 ? Compat::kJpdc2013 : Compat::kNone;
    options.iterations = 1 + static_cast<int>(engine() % 2);
    if (engine() % 3 == 0) options.min_dihedral = uniform(engine, 5, 40);
    options.seed = engine();
    options.policy = {1 + static_cast<int>(step == 2), 1};
    options.statistics = false;
    const Result result = improve(mesh, options);
    for (const PassReport& pass : result.passes) winners += pass.winners;
    ASSERT_EQ(check(mesh), Ok) << "step " << step << ", " << ops_to_list(options.ops);
    ASSERT_TRUE(boundary_of(mesh) == boundary);
    ASSERT_EQ(frozen_places(mesh), frozen);
    ASSERT_EQ(places_of(mesh, mesh.labels().faces), faces);
    ASSERT_EQ(places_of(mesh, mesh.labels().edges), edges);
    for (const auto& [region, sum] : region_volumes(mesh)) ASSERT_NEAR(sum, volumes.at(region), 1e-12);
    ASSERT_LE(invalid_cells(mesh, {}).size(), inverted);
    expect_dense(mesh);
  }
  EXPECT_GT(winners, 50U);
}

// Each jitter with and without labels three times or more. More seeds are those of scripts/fuzz.sh, whose
// cases take fewer seconds each.
INSTANTIATE_TEST_SUITE_P(Seeds, Soak, testing::Range<std::uint64_t>(1, 46));

}  // namespace
}  // namespace hfr::test
