// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceSmooth.hh"

#include <gtest/gtest.h>

#include "Surface/Skin.hh"

namespace hfr::test {
namespace {

TEST(SurfaceSmooth, VertexOfAFacetStaysInItAndOneOfAnEdgeOnIt) {
  TetMesh mesh = jittered_skin(4, 0.4, 3);
  SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
  int n_facet = 0;
  int n_curve = 0;
  for (VertexHandle v : mesh.boundary_vertices()) {
    const auto quality = values(mesh);
    const std::vector<std::uint8_t> none(mesh.n_vertices(), 0);
    const SurfaceSmooth<VolumeLength> op{{}, quality, none, {&surface}};
    const auto plan = op.evaluate(mesh, v);
    if (!plan) continue;
    const SurfaceKind kind = surface.motion_constraint(v).kind;
    ASSERT_TRUE(kind == SurfaceKind::kFacet || kind == SurfaceKind::kCurve);
    (kind == SurfaceKind::kFacet ? n_facet : n_curve) += 1;
    int n_kept = 0;
    for (int d = 0; d < 3; ++d) {
      const double x = mesh.point(v)[d];
      if (x != 0 && x != 1) continue;
      ++n_kept;
      EXPECT_EQ(plan->target[d], x);
    }
    EXPECT_EQ(n_kept, kind == SurfaceKind::kFacet ? 1 : 2);
    mesh.set_point(v, plan->target);
  }
  EXPECT_GT(n_facet, 10);
  EXPECT_GT(n_curve, 5);
}

TEST(SurfaceSmooth, MoveOverACurvedSurfaceKeepsTheVolume) {
  generate::Arrays arrays = generate::ball(3);
  generate::jitter_inner(arrays, 0.2, 4);
  TetMesh mesh = built(arrays);
  SurfaceOptions options = mode(SurfaceMode::kFree);
  options.hausdorff = 0.1;
  SurfaceMesh surface(mesh, options);
  int n_moves = 0;
  for (VertexHandle v : mesh.boundary_vertices()) {
    const double before = volume(mesh);
    const auto quality = values(mesh);
    const std::vector<std::uint8_t> none(mesh.n_vertices(), 0);
    const auto plan = SurfaceSmooth<VolumeLength>{{}, quality, none, {&surface}}.evaluate(mesh, v);
    if (!plan) continue;
    ++n_moves;
    mesh.set_point(v, plan->target);
    EXPECT_NEAR(volume(mesh), before, 1e-13);
  }
  EXPECT_GT(n_moves, 20);
}

}  // namespace
}  // namespace hfr::test
