// SPDX-License-Identifier: BSD-3-Clause
// Small meshes of every kind through every pipeline, with a look at everything round each round.
#include <gtest/gtest.h>

#include "Operators/LimitMeshes.hh"
#include "Remesh/DamagedMeshes.hh"
#include "Remesh/Drivers.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

struct NamedMesh {
  std::string name;
  TetMesh mesh;
};

/// A box without some of its cells: fans, pinched vertices and edges.
TetMesh torn_box(Index n, double keep, std::uint64_t seed) {
  const generate::Arrays arrays = generate::box({n, n, n});
  std::vector<Corners> kept;
  for (std::size_t i = 0; i < arrays.cells.size(); ++i)
    if (generate::random_unit(seed, i) < keep) kept.push_back(arrays.cells[i]);
  return build(arrays.points, kept);
}

TetMesh shaken_hub(Index n) {
  TetMesh mesh = built(hub(n));
  shake_inner(mesh, 0.3 / static_cast<double>(n / 6), n);
  return mesh;
}

std::vector<NamedMesh> meshes() {
  return {{"jittered box", jittered(4, 0.4, 1)},
          {"tangled cavity", small_cavity(5)},
          {"labels and two regions", labelled_box(4, 0.35, 1)},
          {"boxes that touch in a vertex", built(pinched(2, 0.4, 1))},
          {"ring of 64 cells", shaken_hub(64)},
          {"stars of 260 cells", shaken_hub(130)},
          {"every vertex beside every other", built(neighbourly(14))},
          {"parts at vertices", parts_at_vertices()},
          {"tangle of parts", tangle_of_parts()},
          {"eleven cells", eleven_cells()},
          {"inverted and flat", inverted_and_flat()},
          {"flat and overlapping", flat_and_overlapping()},
          {"regions with flat cells", regions_with_flat_cells()},
          {"torn box", torn_box(4, 0.5, 1)},
          {"crumbs", torn_box(4, 0.2, 2)},
          {"ball", built(generate::ball(3))}};
}

class ParanoidPipelines : public testing::TestWithParam<Driver> {};
INSTANTIATE_TEST_SUITE_P(Driver, ParanoidPipelines, testing::ValuesIn(courses()), [](const auto& driver) {
  std::string name = driver.param.name;
  std::erase_if(name, [](char c) { return c == ' ' || c == ','; });
  return name;
});

TEST_P(ParanoidPipelines, KeepTheirBooksAfterEachRound) {
  std::size_t n_rounds = 0, n_winners = 0;
  for (const NamedMesh& input : meshes()) {
    TetMesh one;
    for (const int threads : {1, 3}) {
      SCOPED_TRACE(input.name + ", " + std::to_string(threads) + " threads");
      TetMesh mesh = input.mesh;
      ImproveOptions options = GetParam().options;
      options.policy = {threads, 1};
      Result result;
      ASSERT_NO_THROW(result = improve(mesh, options));
      for (const PassReport& pass : result.passes) {
        n_rounds += pass.rounds;
        n_winners += pass.winners;
      }
      if (threads == 1)
        one = mesh;
      else
        EXPECT_TRUE(identical(one, mesh));
    }
  }
  EXPECT_GT(n_rounds, 500U);
  EXPECT_GT(n_winners, 2000U);
}

}  // namespace
}  // namespace hfr::test
