// SPDX-License-Identifier: BSD-3-Clause
// Swaps and collapses by turns, one cluster at a time: the volume's cells and the surface stay in step, the
// shape and the volume are kept.
#include <gtest/gtest.h>

#include "Surface/Skin.hh"
#include "Surface/SurfaceCollapse.hh"
#include "Surface/SurfaceSwap.hh"

namespace hfr::test {
namespace {

struct Counts {
  int swaps = 0, peels = 0, collapses = 0;
  int hopeless = 0;  // vertices that no collapse gains anything at
};

Counts work_on(TetMesh& mesh, SurfaceMesh& surface) {
  Counts counts;
  const auto expect_sound = [&](double worst_before) {
    ASSERT_EQ(check(mesh), Ok);
    ASSERT_TRUE(surface.in_step(mesh));
    ASSERT_GE(worst(mesh), worst_before);
  };
  std::vector<std::array<VertexHandle, 2>> edges;
  for (EdgeHandle e : mesh.boundary_edges()) edges.push_back(mesh.edge_vertices(e));
  for (const auto& [a, b] : edges) {
    const EdgeHandle e = seed_of(mesh, a, b);
    if (!e.is_valid() || !surface.may_swap(a, b)) continue;
    const auto quality = values(mesh);
    const double before = worst(mesh);
    const SurfaceSwap<VolumeLength> op{{}, quality, &surface};
    const auto plan = try_on(op, mesh, e);
    if (!plan) continue;
    ++counts.swaps;
    counts.peels += plan->n_created + 1 == plan->n_removed ? 1 : 0;
    surface.on_swap(plan->edge[0], plan->edge[1]);
    expect_sound(before);
  }
  std::vector<VertexHandle> vertices;
  for (VertexHandle v : mesh.boundary_vertices()) vertices.push_back(v);
  for (VertexHandle v : vertices) {
    std::vector<VertexHandle> targets;
    surface.collapse_targets(v, targets);
    if (targets.empty()) continue;
    const auto quality = values(mesh);
    const double before = worst(mesh);
    const SurfaceCollapse<VolumeLength> op{{}, quality, &surface, targets};
    const bool may_gain = op.may_gain(mesh, v);
    counts.hopeless += may_gain ? 0 : 1;
    const auto plan = try_on(op, mesh, {v, 0, static_cast<std::uint32_t>(targets.size())});
    if (!plan) continue;
    EXPECT_TRUE(may_gain) << "vertex " << v.idx();
    ++counts.collapses;
    surface.on_collapse(v, plan->onto);
    expect_sound(before);
  }
  return counts;
}

TEST(SurfaceOperatorsProperty, FlatOnesKeepTheBoxAndRaiseTheWorst) {
  Counts sum;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TetMesh mesh = jittered_skin(4, 0.35, seed);
    const double before = volume(mesh);
    SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
    const Counts counts = work_on(mesh, surface);
    sum.swaps += counts.swaps;
    sum.collapses += counts.collapses;
    sum.hopeless += counts.hopeless;
    EXPECT_NEAR(volume(mesh), before, 1e-14);
    for (VertexHandle v : mesh.boundary_vertices()) {
      const Vec3 p = mesh.point(v);
      EXPECT_TRUE(p.x == 0 || p.x == 1 || p.y == 0 || p.y == 1 || p.z == 0 || p.z == 1);
    }
  }
  EXPECT_GT(sum.swaps, 40) << "the boxes no longer have diagonals to swap";
  EXPECT_GT(sum.collapses, 40) << "the boxes no longer have vertices to collapse";
  EXPECT_GT(sum.hopeless, 40) << "no vertex is ruled out before OpenMesh is asked";
}

TEST(SurfaceOperatorsProperty, FreeOnesStayNearABall) {
  Counts sum;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    generate::Arrays arrays = generate::ball(4);
    Engine engine(seed);
    for (Vec3& p : arrays.points) {  // slide the skin over the sphere
      const double r = norm(p);
      if (r < 0.999) continue;
      p = p + random_point(engine, -0.12, 0.12);
      p = (1.0 / norm(p)) * p;
    }
    TetMesh mesh = built(arrays);
    const std::vector<Triangle> input = surface_triangles(mesh);
    SurfaceOptions options = mode(SurfaceMode::kFree);
    options.hausdorff = 0.1;
    SurfaceMesh surface(mesh, options);
    const double before = volume(mesh);
    const Counts counts = work_on(mesh, surface);
    sum.swaps += counts.swaps;
    sum.collapses += counts.collapses;
    EXPECT_NEAR((volume(mesh) - before) / before, surface.volume_gain(), 1e-12);
    EXPECT_LE(surface_distance(input, surface_triangles(mesh), 0.02).hausdorff(), 0.1);
  }
  EXPECT_GT(sum.swaps, 20);
  EXPECT_GT(sum.collapses, 5);
}

}  // namespace
}  // namespace hfr::test
