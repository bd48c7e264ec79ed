// SPDX-License-Identifier: BSD-3-Clause
// Each fixed capacity of the operators on a surface with what it just holds, and with one more.
#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "Operators/LimitMeshes.hh"
#include "Operators/Metrics.hh"
#include "Remesh/ImproveTriangles.hh"
#include "Surface/InterfaceSwap.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceCollapse.hh"
#include "Surface/SurfaceMesh.hh"
#include "Surface/SurfaceSmooth.hh"
#include "Surface/SurfaceSwap.hh"

namespace hfr::test {
namespace {

/// Vertices of a half circle from (1, 0, 0) to (-1, 0, 0) with k sides, on the side of positive or negative
/// y. The last but one stands all but behind its neighbour.
void append_half_circle(Index k, double side, std::vector<Vec3>& points) {
  for (Index i = 0; i <= k; ++i) {
    if (i == 0 || i == k) {
      points.push_back({i == 0 ? 1.0 : -1.0, 0, 0});
      continue;
    }
    const bool behind = i + 1 == k;
    const Index at = behind ? i - 1 : i;
    const double angle =
        std::numbers::pi * (static_cast<double>(at) / static_cast<double>(k) + (behind ? 1e-10 : 0));
    const double radius = behind ? 1.2 : 1;
    points.push_back({radius * std::cos(angle), side * radius * std::sin(angle), 0});
  }
}

TEST(SurfaceCapacities, BoundaryEdgeOf31CellsIsSwappedAndOneOf32LeftAlone) {
  for (const Index k : {Index{30}, Index{31}, Index{32}, Index{33}, Index{64}}) {
    std::vector<Vec3> points = {{0, 0, -0.7}, {0, 0, 0.7}};
    append_half_circle(k, 1, points);
    std::vector<Corners> cells;
    for (Index i = 0; i < k; ++i) cells.push_back({0, 1, i + 2, i + 3});
    TetMesh mesh = build(points, cells);
    const SurfaceMesh surface(mesh, flat_surface());
    ASSERT_TRUE(surface.may_swap(V(0), V(1)));
    const auto quality = values(mesh);
    const auto plan =
        try_on(SurfaceSwap<VolumeLength>{{}, quality, &surface}, mesh, mesh.find_edge(V(0), V(1)));
    EXPECT_EQ(plan.has_value(), k <= SurfaceSwap<VolumeLength>::kMaxRing) << k;
    EXPECT_EQ(check(mesh), Ok);
  }
}

TEST(SurfaceCapacities, InterfaceEdgeOf31CellsASideIsSwappedAndOneOf32LeftAlone) {
  for (const Index k : {Index{30}, Index{31}, Index{32}, Index{33}}) {
    for (const Index other : {Index{4}, k}) {
      std::vector<Vec3> points = {{0, 0, -0.7}, {0, 0, 0.7}};
      append_half_circle(k, 1, points);
      std::vector<Vec3> below;
      append_half_circle(other, -1, below);
      points.insert(points.end(), below.rbegin() + 1, below.rend() - 1);
      const Index n = k + other;
      std::vector<Corners> cells;
      for (Index i = 0; i < n; ++i) cells.push_back({0, 1, i + 2, (i + 1) % n + 2});
      TetMesh mesh = build(points, cells);
      for (Index i = 0; i < n; ++i) mesh.set_region(C(i), i < k ? 1 : 2);
      const SurfaceMesh surface(mesh, flat_surface());
      ASSERT_TRUE(surface.may_swap(V(0), V(1)));
      const auto quality = values(mesh);
      const auto plan =
          try_on(InterfaceSwap<VolumeLength>{{}, quality, &surface}, mesh, mesh.find_edge(V(0), V(1)));
      EXPECT_EQ(plan.has_value(), k <= InterfaceSwap<VolumeLength>::kMaxSide) << k << " and " << other;
      EXPECT_EQ(check(mesh), Ok);
    }
  }
}

/// A disc of n triangles round vertex 0 at `centre` in the plane z = 0, each with a cell below.
TetMesh disc(Index n, Vec3 centre) {
  std::vector<Vec3> points = {centre, {0, 0, -1}};
  std::vector<Corners> cells;
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    points.push_back({std::cos(angle), std::sin(angle), 0});
    cells.push_back({1, 0, i + 2, (i + 1) % n + 2});
  }
  return build(points, cells);
}

std::vector<HalfFaceHandle> link_of(const TetMesh& mesh, VertexHandle v) {
  std::vector<HalfFaceHandle> link;
  for (CellHandle c : mesh.vertex_cells(v)) link.push_back(halfface_of(c, mesh.cell(c).corner(v)));
  return link;
}

TEST(SurfaceCapacities, VertexOf64FacesMovesAndOneOf65IsLeftAlone) {
  for (const Index n : {Index{63}, Index{64}, Index{65}, Index{300}}) {
    const TetMesh mesh = disc(n, {0.5, 0.2, 0});
    const SurfaceMesh surface(mesh, flat_surface());
    const auto link = link_of(mesh, V(0));
    const SurfaceSearch search{&surface};
    const auto by_volume = search(mesh, V(0), link, VolumeLength{}, std::span<const double>(values(mesh)));
    EXPECT_EQ(by_volume.has_value(), n <= 64) << n;
    const auto quality = qualities(mesh, MinSine2{});
    const auto by_angle = search(mesh, V(0), link, MinSine2{}, std::span<const double>(quality));
    EXPECT_EQ(by_angle.has_value(), n <= 64) << n;
  }
}

TEST(SurfaceCapacities, VertexOf64FacesIsCollapsedAndOneOf65LeftAlone) {
  for (const Index n : {Index{63}, Index{64}, Index{65}, Index{300}}) {
    TetMesh mesh = disc(n, {1 - 1e-9, 1e-10, 0});
    SurfaceMesh surface(mesh, flat_surface());
    std::vector<VertexHandle> targets;
    surface.collapse_targets(V(0), targets);
    ASSERT_FALSE(targets.empty());
    const auto quality = values(mesh);
    const SurfaceCollapse<VolumeLength> op{{}, quality, &surface, targets};
    const auto plan = try_on(op, mesh, {V(0), 0, static_cast<std::uint32_t>(targets.size())});
    EXPECT_EQ(plan.has_value(), n <= 64) << n;
    EXPECT_EQ(check(mesh), Ok);
  }
}

TEST(SurfaceCapacities, ChangeThatTouches16RegionsIsJudgedAndOneOf17Refused) {
  for (const Index n : {Index{15}, Index{16}, Index{17}, Index{60}}) {
    TetMesh mesh = disc(n, {0, 0, 0});
    for (Index i = 0; i < n; ++i) mesh.set_region(C(i), static_cast<int>(i));
    SurfaceOptions options;
    options.mode = SurfaceMode::kFree;
    options.hausdorff = 0.1;
    const SurfaceMesh surface(mesh, options);
    std::vector<std::array<VertexHandle, 3>> faces;
    surface.star(V(0), faces);
    ASSERT_EQ(faces.size(), 2 * n) << "of the boundary, and between the regions";
    std::vector<Triangle> removed, created;
    for (const auto& f : faces) {
      removed.push_back({mesh.point(f[0]), mesh.point(f[1]), mesh.point(f[2])});
      created.push_back(removed.back());
      for (Vec3& p : created.back())
        if (p == mesh.point(V(0))) p = {1e-6, 2e-6, 0};
    }
    EXPECT_EQ(surface.keeps_shape(faces, removed, created), n <= 16) << n;
  }
}

TEST(SurfaceCapacities, TrianglesRoundAVertexMayBeAnyNumber) {
  for (const Index n : {Index{11}, Index{12}, Index{13}, Index{64}, Index{65}, Index{300}}) {
    TriangleMesh mesh;
    mesh.points = {{0.6, 0.3, 0}};
    for (Index i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      mesh.points.push_back({std::cos(angle), std::sin(angle), 0});
      mesh.triangles.push_back({V(0), V(i + 1), V((i + 1) % n + 1)});
    }
    TriangleOptions options;
    options.surface.mode = SurfaceMode::kFlat;
    options.policy = {};
    const TriangleResult result = improve_triangles(mesh, options);
    EXPECT_EQ(result.after.open_edges, n) << "corners stay";
    EXPECT_EQ(result.after.non_manifold_edges, 0U);
    EXPECT_GE(result.after.min_angle.min, result.before.min_angle.min);
    EXPECT_NEAR(result.after.area, result.before.area, 1e-12);
  }
}

}  // namespace
}  // namespace hfr::test
