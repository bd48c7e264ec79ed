// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceSplit.hh"

#include <gtest/gtest.h>

#include "Surface/Skin.hh"

namespace hfr::test {
namespace {

TEST(SurfaceSplitProperty, NewVerticesLieWhereTheEdgeWasAndRaiseTheWorst) {
  int n_facet = 0;
  int n_curve = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TetMesh mesh = jittered_skin(4, 0.45, seed);
    const double before = volume(mesh);
    SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
    std::vector<std::array<VertexHandle, 2>> edges;
    for (EdgeHandle e : mesh.boundary_edges()) edges.push_back(mesh.edge_vertices(e));
    for (const auto& [a, b] : edges) {
      const EdgeHandle e = seed_of(mesh, a, b);
      if (!e.is_valid() || !surface.may_split(a, b)) continue;
      const bool is_feature = surface.is_feature(a, b);
      const auto quality = values(mesh);
      const double worst_before = worst(mesh);
      const SurfaceSplit<VolumeLength> op{{}, quality, &surface};
      const auto plan = try_on(op, mesh, SurfaceSplit<VolumeLength>::Seed(e));
      if (!plan) continue;
      const VertexHandle middle(mesh.n_vertices() - 1);
      surface.on_split(a, b, middle, plan->place);
      ASSERT_EQ(check(mesh), Ok);
      ASSERT_TRUE(surface.in_step(mesh));
      EXPECT_GE(worst(mesh), worst_before);
      EXPECT_EQ(surface.motion_constraint(middle).kind,
                is_feature ? SurfaceKind::kCurve : SurfaceKind::kFacet);
      EXPECT_EQ(surface.is_feature(a, middle), is_feature);
      (is_feature ? n_curve : n_facet) += 1;
    }
    EXPECT_NEAR(volume(mesh), before, 1e-14);
  }
  EXPECT_GT(n_facet, 10) << "no edge of a facet is worth a vertex any more";
  EXPECT_GT(n_curve, 2) << "no feature edge is worth a vertex any more";
}

/// Whatever cell of the ring is the seed, and whichever the cavity begins with.
TEST(SurfaceSplit, ARimIsToldOfTheSeedThatHasComeThere) {
  const TetMesh mesh = jittered_skin(4, 0.3, 2);
  const SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
  const auto quality = values(mesh);
  SurfaceSplit<VolumeLength> op{{}, quality, &surface};
  CutRim rim;
  rim.is_rim.assign(mesh.n_cells(), 1);
  op.rim = &rim;
  std::size_t n_seeds = 0;
  for (CellHandle c : mesh.cells())
    for (Index k = 0; k < 6; ++k) {
      const EdgeHandle e(6 * c.idx() + k);
      const auto [a, b] = mesh.edge_vertices(e);
      if (!mesh.is_boundary(e) || !surface.may_split(a, b)) continue;
      rim.has_met.assign(mesh.n_cells(), 0);
      op.evaluate(mesh, SurfaceSplit<VolumeLength>::Seed(e));
      for (CellHandle other : mesh.cells()) EXPECT_EQ(rim.has_met[other.idx()], other == c ? 1 : 0);
      ++n_seeds;
    }
  EXPECT_GT(n_seeds, 200U);
}

}  // namespace
}  // namespace hfr::test
