// SPDX-License-Identifier: BSD-3-Clause
// One cluster at a time: the volume's cells and the surface stay in step, the shape and the volume are kept.
#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/Metrics.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceCollapse.hh"
#include "Surface/SurfaceMesh.hh"
#include "Surface/SurfaceSmooth.hh"
#include "Surface/SurfaceSplit.hh"
#include "Surface/SurfaceSwap.hh"

namespace hfr::test {
namespace {

SurfaceOptions mode(SurfaceMode m) {
  SurfaceOptions options;
  options.mode = m;
  return options;
}

/// A box whose vertices are jittered within its facets and along its edges, too.
TetMesh jittered_skin(Index n, double jitter, std::uint64_t seed) {
  TetMesh mesh = jittered(n, jitter, seed);
  Engine engine(seed);
  for (VertexHandle v : mesh.vertices()) {
    Vec3 p = mesh.point(v);
    for (int d = 0; d < 3; ++d) {
      const double step = jitter / static_cast<double>(n) * uniform(engine, -1, 1);
      if (mesh.is_boundary(v) && p[d] != 0 && p[d] != 1) p[d] += step;
    }
    mesh.set_point(v, p);
  }
  return mesh;
}

/// Any cell with the edge; a surface edge is named by two vertices, since cells come and go.
EdgeHandle seed_of(const TetMesh& mesh, VertexHandle a, VertexHandle b) { return mesh.find_edge(a, b); }

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

/// Four vertices of the unit square's corners on the plane z = 0 and one above: two cells, whose diagonal is
/// the wrong one for an apex above a corner.
TEST(SurfaceSwap, DiagonalThatFlattensACellGivesWay) {
  TetMesh mesh = build({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.9, 0.05, 0.6}},
                       std::vector<Corners>{{0, 1, 2, 4}, {0, 2, 3, 4}});
  ASSERT_EQ(check(mesh), Ok);
  SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
  const auto quality = values(mesh);
  const double before = worst(mesh);
  ASSERT_TRUE(surface.may_swap(V(0), V(2)));
  EXPECT_FALSE(surface.may_swap(V(0), V(1)));
  const auto plan =
      try_on(SurfaceSwap<VolumeLength>{{}, quality, &surface}, mesh, mesh.find_edge(V(0), V(2)));
  ASSERT_TRUE(plan);
  surface.on_swap(V(0), V(2));
  EXPECT_TRUE(surface.in_step(mesh));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_FALSE(mesh.find_edge(V(0), V(2)).is_valid());
  EXPECT_TRUE(mesh.find_edge(V(1), V(3)).is_valid());
  EXPECT_GT(worst(mesh), before);
}

TEST(SurfaceSwap, FlatCellUnderTwoFacesIsPeeledOff) {
  // A regular octahedron's upper half over a square that an all but flat cell covers from below.
  TetMesh mesh = build({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.8}},
                       std::vector<Corners>{{0, 1, 3, 4}, {1, 2, 3, 4}, {0, 2, 1, 3}});
  SurfaceMesh surface(mesh, mode(SurfaceMode::kFlat));
  EXPECT_EQ(worst(mesh), 0);
  const auto quality = values(mesh);
  const auto plan =
      try_on(SurfaceSwap<VolumeLength>{{}, quality, &surface}, mesh, mesh.find_edge(V(0), V(2)));
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->n_removed, 3U);
  EXPECT_EQ(plan->n_created, 2U);
  surface.on_swap(V(0), V(2));
  EXPECT_TRUE(surface.in_step(mesh));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(worst(mesh), 0);
}

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
