// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/SurfaceCollapse.hh"

#include <gtest/gtest.h>

#include "Surface/Skin.hh"

namespace hfr::test {
namespace {

/// A box of eight cubes, the middle of whose upper side has been pulled towards a side of that.
TetMesh pulled_box() {
  TetMesh mesh = built(generate::box({2, 2, 2}));
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    if (p.x == 0.5 && p.y == 0.5 && p.z == 1) mesh.set_point(v, {0.97, 0.52, 1});
  }
  return mesh;
}

VertexHandle pulled(const TetMesh& mesh) {
  for (VertexHandle v : mesh.vertices())
    if (mesh.point(v).x == 0.97) return v;
  return {};
}

TEST(SurfaceCollapse, VertexOfAFacetThatMakesSliversGoesAndTheSideStaysFlat) {
  TetMesh mesh = pulled_box();
  const VertexHandle v = pulled(mesh);
  SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
  std::vector<VertexHandle> targets;
  surface.collapse_targets(v, targets);
  ASSERT_FALSE(targets.empty());
  for (VertexHandle w : targets) EXPECT_EQ(mesh.point(w).z, 1) << "leads out of the facet";
  const auto quality = values(mesh);
  const double before = worst(mesh);
  const SurfaceCollapse<VolumeLength> op{{}, quality, &surface, targets};
  EXPECT_TRUE(op.may_gain(mesh, v));
  const auto plan = try_on(op, mesh, {v, 0, static_cast<std::uint32_t>(targets.size())});
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->removes_vertex);
  EXPECT_GT(plan->n_removed, plan->n_created);
  surface.on_collapse(v, plan->onto);
  EXPECT_TRUE(surface.in_step(mesh));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(mesh.is_deleted(v));
  EXPECT_NEAR(volume(mesh), 1, 1e-14);
  EXPECT_GT(worst(mesh), before);
}

TEST(SurfaceCollapse, CornersHaveNoTargetsAndVerticesOfAFeatureOnlyAlongIt) {
  const TetMesh mesh = built(generate::box({3, 3, 3}));
  SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
  int n_corners = 0, n_on_edges = 0;
  for (VertexHandle v : mesh.boundary_vertices()) {
    std::vector<VertexHandle> targets;
    surface.collapse_targets(v, targets);
    const Vec3 p = mesh.point(v);
    const auto on_sides = [](Vec3 x) {
      int n = 0;
      for (int d = 0; d < 3; ++d) n += x[d] == 0 || x[d] == 1 ? 1 : 0;
      return n;
    };
    if (on_sides(p) == 3) {
      ++n_corners;
      EXPECT_TRUE(targets.empty());
    } else if (on_sides(p) == 2) {
      ++n_on_edges;
      for (VertexHandle w : targets) EXPECT_TRUE(surface.is_feature(v, w));
    }
  }
  EXPECT_EQ(n_corners, 8);
  EXPECT_EQ(n_on_edges, 24);
}

TEST(SurfaceCollapse, VertexOfARegionOfOneCellDoesNotLayItsFacesUponOneAnother) {
  // The second cell is flat: vertex 3 is in the middle of the edge from 1 to 4, and with it the region would
  // go.
  TetMesh mesh =
      build({{1, 1, 2}, {2, 2, 4}, {3, 2, 1}, {2, 1, 2}, {2, 0, 0}, {0, -1, 3}},
            std::vector<Corners>{{3, 1, 2, 5}, {2, 1, 4, 3}, {2, 3, 4, 5}, {3, 5, 4, 1}, {1, 2, 0, 4}});
  SurfaceMesh whole(mesh, mode(SurfaceMode::kFree));
  ASSERT_EQ(whole.motion_constraint(V(3)).kind, SurfaceKind::kInside);
  mesh.set_region(C(1), 1);
  SurfaceMesh surface(mesh, mode(SurfaceMode::kFree));
  ASSERT_EQ(surface.motion_constraint(V(3)).kind, SurfaceKind::kCurve);
  std::vector<VertexHandle> targets;
  surface.collapse_targets(V(3), targets);
  EXPECT_TRUE(targets.empty());
}

}  // namespace
}  // namespace hfr::test
