// SPDX-License-Identifier: BSD-3-Clause
// improve() with a surface that may change.
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "IO/Hash.hh"
#include "Quality/Statistics.hh"
#include "Remesh/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

ImproveOptions with(SurfaceMode mode) {
  ImproveOptions options = serial();
  options.surface.mode = mode;
  return options;
}

std::size_t surface_changes(const Result& result) {
  std::size_t n = 0;
  for (const PassReport& pass : result.passes)
    if (pass.op.starts_with("surface")) n += pass.winners;
  return n;
}

/// Area per patch label of the boundary.
std::map<int, double> patch_areas(const TetMesh& mesh) {
  std::map<int, double> areas;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);
    const int* label = mesh.labels().faces.find(f);
    const Vec3 p = mesh.point(f[0]);
    areas[label ? *label : 0] += 0.5 * norm(cross(mesh.point(f[1]) - p, mesh.point(f[2]) - p));
  }
  return areas;
}

TetMesh twisted_cylinder() {
  generate::Arrays arrays = generate::cylinder(4, 6, 1, 2, 50);
  generate::jitter_inner(arrays, 0.2, 5);
  return built(arrays);
}

TEST(SurfaceRuns, FlatBeatsFrozenAndKeepsTheCubeExactly) {
  TetMesh frozen = small_cavity(8);
  TetMesh flat = frozen;
  improve(frozen, serial());
  const Result result = improve(flat, with(SurfaceMode::kFlat));
  EXPECT_EQ(check(flat), Ok);
  EXPECT_GT(surface_changes(result), 100U);
  EXPECT_GT(result.after.min_dihedral.min, statistics(frozen, {}).min_dihedral.min);
  EXPECT_NEAR(volume(flat), 1, 1e-12);
  EXPECT_LT(result.surface.hausdorff, 1e-15);
  EXPECT_LT(std::abs(result.surface.volume_change), 1e-12);
  int n_corners = 0;
  for (VertexHandle v : flat.boundary_vertices()) {
    const Vec3 p = flat.point(v);
    int n_on = 0;
    for (int d = 0; d < 3; ++d) n_on += p[d] == 0 || p[d] == 1;
    EXPECT_GE(n_on, 1) << "a vertex has left its plane";
    n_corners += n_on == 3;
  }
  EXPECT_EQ(n_corners, 8);
}

TEST(SurfaceRuns, FlatKeepsRegionsPatchesAndLabels) {
  TetMesh mesh = labelled_box(5, 0.4, 5);
  mesh.labels().vertices.clear();
  const auto volumes = region_volumes(mesh);
  const auto areas = patch_areas(mesh);
  ASSERT_EQ(areas.size(), 6U);
  const auto edges = places_of(mesh, mesh.labels().edges);
  const Result result = improve(mesh, with(SurfaceMode::kFlat));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(surface_changes(result), 20U);
  for (const auto& [region, v] : region_volumes(mesh)) EXPECT_NEAR(v, volumes.at(region), 1e-12);
  const auto areas_after = patch_areas(mesh);
  ASSERT_EQ(areas_after.size(), areas.size());
  for (const auto& [patch, area] : areas_after) EXPECT_NEAR(area, areas.at(patch), 1e-12);
  EXPECT_EQ(places_of(mesh, mesh.labels().edges), edges);
  // No label is left on what is no face of the surface any more.
  for (const auto& entry : mesh.labels().faces.entries()) {
    const HalfFaceHandle h = mesh.find_halfface(entry.vertices);
    ASSERT_TRUE(h.is_valid()) << "no such face, or named from the other side than before";
    EXPECT_TRUE(mesh.is_constrained(h));
    EXPECT_EQ(mesh.is_boundary(h), entry.value != 7);
  }
}

TEST(SurfaceRuns, FixedPatchKeepsEveryBit) {
  TetMesh mesh = labelled_box(5, 0.4, 6);
  const auto patch = [](const TetMesh& m, int label) {
    std::set<std::set<Place>> faces;
    for (const auto& [corners, value] : places_of(m, m.labels().faces))
      if (value == label) faces.insert(corners);
    return faces;
  };
  const auto kept = patch(mesh, 3);
  const auto other = patch(mesh, 4);
  ASSERT_GT(kept.size(), 20U);
  ImproveOptions options = with(SurfaceMode::kFlat);
  options.surface.fixed_patches = {3};
  improve(mesh, options);
  EXPECT_EQ(patch(mesh, 3), kept);
  EXPECT_NE(patch(mesh, 4), other) << "nothing has changed anywhere";
}

TEST(SurfaceRuns, FreeStaysWithinItsDistanceAndKeepsTheVolume) {
  TetMesh mesh = twisted_cylinder();
  const std::vector<Triangle> input = surface_triangles(mesh);
  const double before = volume(mesh);
  ImproveOptions options = with(SurfaceMode::kFree);
  options.surface.hausdorff = 0.05;
  const Result result = improve(mesh, options);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(surface_changes(result), 50U);
  EXPECT_LE(result.surface.hausdorff, 0.05);
  EXPECT_GT(result.surface.hausdorff, 0);
  EXPECT_LE(surface_distance(input, surface_triangles(mesh), 0.02).hausdorff(), 0.05);
  EXPECT_NEAR(volume(mesh) / before, 1, 1e-3);
  EXPECT_NEAR(result.surface.volume_change, volume(mesh) / before - 1, 1e-9);
  for (VertexHandle v : mesh.boundary_vertices()) {  // the two ends are planes
    const Vec3 p = mesh.point(v);
    if (std::abs(p.z) < 0.01 || std::abs(p.z - 2) < 0.01) {
      EXPECT_TRUE(p.z == 0 || p.z == 2 || p.x * p.x + p.y * p.y > 0.7) << p.z;
    }
  }
}

TEST(SurfaceRuns, FreeKeepsTheCornersAndEdgesOfABox) {
  TetMesh mesh = jittered(5, 0.3, 9);
  const Result result = improve(mesh, with(SurfaceMode::kFree));
  EXPECT_GT(surface_changes(result), 20U);
  EXPECT_NEAR(volume(mesh), 1, 1e-12);
  EXPECT_LT(result.surface.hausdorff, 1e-14);
  const SurfaceMesh surface(mesh, with(SurfaceMode::kFree).surface);
  EXPECT_EQ(surface.n_vertices(SurfaceKind::kFixed), 8U);
}

// The case of D'Amato & Venere (2013), figure 3.
TEST(SurfaceRuns, CylinderWhoseSideFoldsOverIsRepairedUnlessFrozen) {
  const TetMesh folded = built(generate::cylinder(6, 16, 1, 2, 0, /*wring=*/70));
  ImproveOptions options = with(SurfaceMode::kFrozen);
  options.time_limit = 60;
  TetMesh frozen = folded;
  const Result kept = improve(frozen, options);
  EXPECT_FALSE(kept.goal_reached);
  EXPECT_GT(kept.invalid_cells.size(), 5U);
  EXPECT_GT(kept.folded_faces.size(), 0U);

  TetMesh mesh = folded;
  options.surface.mode = SurfaceMode::kFree;
  options.surface.hausdorff = 0.03;
  const Result result = improve(mesh, options);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(result.goal_reached);
  EXPECT_TRUE(result.invalid_cells.empty());
  EXPECT_GT(result.after.min_dihedral.min, 15);
  EXPECT_LE(result.surface.hausdorff, 0.031);
  EXPECT_LT(std::abs(result.surface.volume_change), 1e-3);
  EXPECT_EQ(result.surface.bound, 0.03);
  for (VertexHandle v : mesh.boundary_vertices()) {
    const Vec3 p = mesh.point(v);
    EXPECT_LT(std::hypot(p.x, p.y), 1 + 0.031);
  }
}

TEST(SurfaceRuns, HausdorffOfZeroIsFlat) {
  TetMesh mesh = small_cavity(6);
  TetMesh flat = mesh;
  ImproveOptions options = with(SurfaceMode::kFree);
  options.surface.hausdorff = 0;
  const Result result = improve(mesh, options);
  improve(flat, with(SurfaceMode::kFlat));
  EXPECT_EQ(io::mesh_hash(mesh), io::mesh_hash(flat));
  EXPECT_EQ(result.surface.mode, SurfaceMode::kFlat);
}

TEST(SurfaceRuns, EveryNumberOfThreadsGivesTheSameBits) {
  struct Case {
    const char* name;
    SurfaceMode mode;
    TetMesh mesh;
  };
  const Case cases[] = {{"flat cavity", SurfaceMode::kFlat, small_cavity(6)},
                        {"flat regions", SurfaceMode::kFlat, labelled_box(4, 0.4, 5)},
                        {"free cylinder", SurfaceMode::kFree, twisted_cylinder()}};
  for (const Case& c : cases) {
    std::optional<std::uint64_t> first;
    for (const int threads : {1, 2, 3, 7}) {
      TetMesh mesh = c.mesh;
      ImproveOptions options = with(c.mode);
      options.policy = {threads, /*serial_below=*/1};
      options.statistics = false;
      const Result result = improve(mesh, options);
      EXPECT_GT(surface_changes(result), 10U) << c.name;
      EXPECT_EQ(check(mesh), Ok) << c.name;
      const std::uint64_t hash = io::mesh_hash(mesh);
      if (!first) first = hash;
      EXPECT_EQ(hash, *first) << c.name << ", " << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace hfr::test
