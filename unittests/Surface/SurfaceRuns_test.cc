// SPDX-License-Identifier: BSD-3-Clause
// improve() with a surface that may change.
#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <optional>

#include "HalfFace/Check.hh"
#include "HalfFace/Errors.hh"
#include "IO/Hash.hh"
#include "Quality/Statistics.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

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
  for (const auto& [patch, area] : areas)
    EXPECT_GT(area, 1 - 1e-12) << "more where triangles are folded over";
  for (const auto& [patch, area] : areas_after) EXPECT_NEAR(area, 1, 1e-12);
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

TEST(SurfaceRuns, FrozenSaysWhatTheSurfaceHoldsBackAndWhatWouldFreeIt) {
  // A block with a corner cut to 12 degrees: the shape itself rules out 20 degrees there, and in any mode.
  const auto sheared = [](double slope, double bend) {
    generate::Arrays arrays = generate::box({4, 4, 4});
    for (Vec3& p : arrays.points) {
      p.x += slope * p.y;
      p.y += bend * p.x * p.x;
    }
    return built(arrays);
  };
  const auto held = [](TetMesh mesh, SurfaceMode mode, double goal) {
    ImproveOptions options = with(mode);
    options.min_dihedral = goal;
    options.ops = without(options.ops, Ops::kInsert);  // new vertices would mend most of them
    return improve(mesh, options);
  };
  const Result wedge = held(sheared(std::tan(78 * std::numbers::pi / 180), 0), SurfaceMode::kFrozen, 20);
  ASSERT_GT(wedge.held.cells, 0U);
  EXPECT_TRUE(wedge.held.known);
  EXPECT_GT(wedge.held.by_shape, 0U);
  EXPECT_EQ(wedge.held.by_flat + wedge.held.by_free + wedge.held.by_shape, wedge.held.cells);

  // Jittered sides of a cube: flat frees what they hold. On a bent side only free does.
  const auto bent = [](double bend) {
    generate::Arrays arrays = generate::jittered_box({5, 5, 5}, 0.35, 4);
    for (Vec3& p : arrays.points) p = p + bend * dot(p, p) * Vec3{p.y, p.z, p.x};
    return built(arrays);
  };
  const Result flat = held(bent(0), SurfaceMode::kFrozen, 30);
  ASSERT_GT(flat.held.cells, 0U);
  EXPECT_EQ(flat.held.by_flat, flat.held.cells);
  const Result curved = held(bent(0.2), SurfaceMode::kFrozen, 42);
  ASSERT_GT(curved.held.cells, 0U);
  EXPECT_EQ(curved.held.by_flat, 0U);
  EXPECT_GT(curved.held.by_free, 0U);
  EXPECT_EQ(held(bent(0), SurfaceMode::kFlat, 30).held.cells, 0U) << "counted for a frozen surface only";
}

TEST(Surface, WhatAFoldOfTheBoundaryHoldsIsFreedByWhatFreesTheFold) {
  // A pressed box with jittered sides: two of its faces fold onto one another, and no mesh with them is
  // without an invalid cell. The one that there is has corners of the box only.
  generate::Arrays arrays = generate::jittered_box({4, 4, 4}, 0.35, 20);
  for (Vec3& p : arrays.points) p.z *= 0.1;
  const TetMesh input = built(arrays);
  const auto run = [&](SurfaceMode mode) {
    TetMesh mesh = input;
    return improve(mesh, with(mode));
  };
  const Result frozen = run(SurfaceMode::kFrozen);
  ASSERT_GT(frozen.unfillable_faces.size(), 0U);
  ASSERT_GT(frozen.after.inverted.size() + frozen.after.flat.size(), 0U);
  ASSERT_GT(frozen.held.cells, 0U);
  const Result flat = run(SurfaceMode::kFlat);
  ASSERT_EQ(flat.after.inverted.size() + flat.after.flat.size(), 0U) << "there is nothing to be freed";
  EXPECT_EQ(frozen.held.by_shape, 0U);
}

/// A sector of a ring with a bent roof: straight and round sharp edges, smooth walls, and flat sides.
TetMesh fan(double jitter) {
  generate::Arrays arrays = generate::jittered_box({8, 4, 4}, jitter, 7);
  for (Vec3& p : arrays.points) {
    const double angle = std::numbers::pi / 2 * p.x;
    const double r = 1 + p.y;
    const double z = p.z * (1 + 0.1 * std::sin(2 * angle) * p.y);
    // The sines and cosines of the ends are exact, so that the flat sides are.
    p = {p.x == 1 ? 0 : r * std::cos(angle), p.x == 0 ? 0 : r * std::sin(angle), z};
  }
  return built(arrays);
}

/// Ends of the feature edges, and the corners in which they meet.
struct Sharp {
  std::set<Place> corners;
  std::size_t n_edges = 0;
};
Sharp sharp_of(const TetMesh& mesh, SurfaceMode mode) {
  const SurfaceMesh surface(mesh, with(mode).surface);
  Sharp sharp;
  sharp.n_edges = surface.n_feature_edges();
  for (VertexHandle v : mesh.boundary_vertices())
    if (surface.motion_constraint(v).kind == SurfaceKind::kFixed) sharp.corners.insert(place_of(mesh, v));
  return sharp;
}

TEST(SurfaceRuns, FanKeepsCornersSharpEdgesAndFlatSides) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TetMesh mesh = fan(0.2);
    const Sharp before = sharp_of(mesh, SurfaceMode::kFree);
    ASSERT_EQ(before.corners.size(), 8U);
    ImproveOptions options = with(mode);
    const Result result = improve(mesh, options);
    EXPECT_EQ(check(mesh), Ok);
    EXPECT_GT(surface_changes(result), 20U);
    EXPECT_EQ(sharp_of(mesh, SurfaceMode::kFree).corners, before.corners);
    for (VertexHandle v : mesh.boundary_vertices()) {
      const Vec3 p = mesh.point(v);
      // The flat sides are x = 0, y = 0 and z = 0: on each exactly, or away from it.
      for (int d = 0; d < 3; ++d) EXPECT_TRUE(p[d] == 0 || p[d] > 0.02) << "coordinate " << d << ": " << p[d];
    }
    if (mode == SurfaceMode::kFlat) {
      EXPECT_LT(std::abs(result.surface.volume_change), 1e-12);
      EXPECT_LT(result.surface.hausdorff, 1e-14);
    } else {
      EXPECT_LE(result.surface.hausdorff, result.surface.bound);
      EXPECT_LT(std::abs(result.surface.volume_change), 1e-3);
    }
  }
}

TEST(SurfaceRuns, CylinderKeepsItsEndsAndRims) {
  generate::Arrays arrays = generate::cylinder(4, 8, 1, 2, 60);
  generate::jitter_inner(arrays, 0.3, 2);
  TetMesh mesh = built(arrays);
  const Result result = improve(mesh, with(SurfaceMode::kFree));
  EXPECT_GT(surface_changes(result), 20U);
  for (VertexHandle v : mesh.boundary_vertices()) {
    const double z = mesh.point(v).z;
    EXPECT_TRUE(z == 0 || z == 2 || (z > 0.02 && z < 1.98)) << z;
  }
  EXPECT_LE(result.surface.hausdorff, result.surface.bound);
}

TEST(SurfaceRuns, CellAtANarrowSharpEdgeIsBlamedOnIt) {
  // A roof whose ridge leaves 10 degrees inside.
  const double half = 5 * std::numbers::pi / 180;
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TetMesh mesh = build({{-1, 0, 0},
                          {1, 0, 0},
                          {0, std::sin(half), std::cos(half)},
                          {0, -std::sin(half), std::cos(half)},
                          {0, 0, 3}},
                         std::vector<Corners>{{0, 1, 2, 3}, {0, 2, 4, 3}, {1, 4, 2, 3}});
    ImproveOptions options = with(mode);
    options.min_dihedral = 15;
    const Result result = improve(mesh, options);
    EXPECT_FALSE(result.goal_reached);
    const auto counts = count_reasons(result.stuck);
    // In free mode the faces may tilt, so that is no proof.
    if (mode == SurfaceMode::kFlat) {
      EXPECT_GE(counts[static_cast<std::size_t>(StuckReason::kSurfaceFeature)], 1U);
    } else {
      EXPECT_EQ(counts[static_cast<std::size_t>(StuckReason::kSurfaceFeature)], 0U);
    }
    EXPECT_EQ(counts[static_cast<std::size_t>(StuckReason::kSurfaceCeiling)], 0U);
  }
}

TEST(SurfaceRuns, FixedPatchesStayMatched) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TetMesh mesh = labelled_box(5, 0.3, 8);
    // Both sides along x get the jitter of one of them, and so match.
    std::map<std::pair<long, long>, Vec3> low;
    const TetMesh regular = built(generate::box({5, 5, 5}));
    for (VertexHandle v : regular.vertices())
      if (regular.point(v).x == 0) {
        const Vec3 p = regular.point(v);
        low[{std::lround(5 * p.y), std::lround(5 * p.z)}] = mesh.point(v);
      }
    for (VertexHandle v : regular.vertices()) {
      const Vec3 p = regular.point(v);
      if (p.x != 1) continue;
      const Vec3 match = low.at({std::lround(5 * p.y), std::lround(5 * p.z)});
      mesh.set_point(v, {1, match.y, match.z});
    }
    const auto side = [](const TetMesh& m, double x) {
      std::set<std::set<std::pair<double, double>>> faces;
      for (HalfFaceHandle h : m.boundary_halffaces()) {
        std::set<std::pair<double, double>> corners;
        for (VertexHandle v : m.halfface_vertices(h))
          if (m.point(v).x == x) corners.emplace(m.point(v).y, m.point(v).z);
        if (corners.size() == 3) faces.insert(corners);
      }
      return faces;
    };
    ASSERT_EQ(side(mesh, 0).size(), 50U);
    ASSERT_EQ(side(mesh, 0), side(mesh, 1));
    ImproveOptions options = with(mode);
    options.surface.fixed_patches = {1, 2};
    const Result result = improve(mesh, options);
    EXPECT_GT(surface_changes(result), 10U);
    EXPECT_EQ(side(mesh, 0).size(), 50U);
    EXPECT_EQ(side(mesh, 0), side(mesh, 1)) << "torn apart";
  }
}

TEST(SurfaceRuns, CoarseningTakesVerticesOfTheSurfaceToo) {
  const TetMesh input = jittered(8, 0.4, 3);
  ImproveOptions options = with(SurfaceMode::kFlat);
  options.raise_min_dihedral = true;
  TetMesh kept = input;
  const Result without = improve(kept, options);
  TetMesh mesh = input;
  options.coarsen = true;
  const Result result = improve(mesh, options);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_LT(result.after.cells, without.after.cells);
  EXPECT_LT(result.surface.triangles_after, result.surface.triangles_before);
  EXPECT_GT(result.after.min_dihedral.min, without.after.min_dihedral.min - 1);
  EXPECT_NEAR(volume(mesh), 1, 1e-13);
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

TEST(SurfaceRuns, RaisingTheWorstAtAnyCostLeavesCellsToWorkIn) {
  // Layers so thin that more vertices are better away than the default run takes, which has no lower bound on
  // cells; swaps take cells beyond the bound, too.
  for (const auto& [n, layers] : {std::pair<Index, Index>{3, 16}, {5, 14}}) {
    const TetMesh first = built(generate::jittered_box({n, n, layers}, 0.1, 1, {0, 0, 0}, {1, 1, 1}));
    ImproveOptions options = with(SurfaceMode::kFlat);
    options.raise_min_dihedral = true;
    options.ops = without(options.ops, Ops::kInsert);
    TetMesh bounded = first;
    improve(bounded, options);
    options.min_cells = 1;
    TetMesh free = first;
    improve(free, options);
    EXPECT_GT(10 * bounded.n_cells(), 11 * free.n_cells()) << n;
  }
}

TEST(SurfaceRuns, RaisingTheWorstAtAnyCostKeepsTheNumberOfCellsInBounds) {
  const TetMesh first = built(generate::jittered_box({6, 3, 2}, 0.1, 1, {0, 0, 0}, {1, 1, 0.5}));
  ImproveOptions options = with(SurfaceMode::kFlat);
  options.raise_min_dihedral = true;
  TetMesh bounded = first;
  const Result result = improve(bounded, options);
  EXPECT_GT(result.after.min_dihedral.min, 35);
  EXPECT_LE(bounded.n_cells(), first.n_cells() * 119 / 100);
  EXPECT_GE(bounded.n_cells(), first.n_cells() * 81 / 100);
  options.max_cells = 100 * first.n_cells();
  TetMesh wider = first;
  improve(wider, options);
  EXPECT_GT(wider.n_cells(), first.n_cells() * 119 / 100)
      << bounded.n_cells() << ' ' << wider.n_cells() << ' ' << first.n_cells();
}

}  // namespace
}  // namespace hfr::test
