// SPDX-License-Identifier: BSD-3-Clause
// Interfaces between regions: both sides change in one step, and keep their regions, labels and volumes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "HalfFace/Check.hh"
#include "IO/Hash.hh"
#include "Operators/Metrics.hh"
#include "Surface/HeldCells.hh"
#include "Surface/InterfaceSwap.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceCollapse.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

/// A box of two regions, jittered, whose interface is the plane x = 0.5 and labelled 7; its vertices are
/// jittered within the plane.
TetMesh halves(Index n, double jitter, std::uint64_t seed) {
  generate::Arrays arrays = generate::jittered_box({n, n, n}, jitter, seed);
  arrays.regions = generate::two_region_box({n, n, n}).regions;
  const generate::Arrays regular = generate::box({n, n, n});
  for (std::size_t i = 0; i < arrays.points.size(); ++i)
    if (regular.points[i].x == 0.5) arrays.points[i].x = 0.5;
  TetMesh mesh = built(arrays);
  for (HalfFaceHandle h : mesh.halffaces()) {
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    if (m.is_valid() && mesh.region(cell_of(h)) < mesh.region(cell_of(m)))
      mesh.labels().faces.set(mesh.halfface_vertices(h), 7);
  }
  return mesh;
}

/// A ball with a core of its own region. Vertices have slid over the core's skin, by up to `slide`.
TetMesh cored_ball(double slide, std::uint64_t seed) {
  generate::Arrays arrays = generate::ball(4);
  for (const auto& cell : arrays.cells) {
    Vec3 centre;
    for (Index v : cell) centre = centre + 0.25 * arrays.points[v];
    arrays.regions.push_back(norm(centre) < 0.5 ? 1 : 2);
  }
  Engine engine(seed);
  for (Vec3& p : arrays.points) {
    if (std::abs(norm(p) - 0.5) > 1e-9) continue;
    p = p + random_point(engine, -slide, slide);
    p = (0.5 / norm(p)) * p;
  }
  return built(arrays);
}

std::vector<Triangle> interface_of(const TetMesh& mesh) {
  std::vector<Triangle> all;
  for (HalfFaceHandle h : mesh.halffaces()) {
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    if (!m.is_valid() || mesh.region(cell_of(h)) >= mesh.region(cell_of(m))) continue;
    const auto f = mesh.halfface_vertices(h);
    all.push_back({mesh.point(f[0]), mesh.point(f[2]), mesh.point(f[1])});
  }
  return all;
}

std::size_t winners(const Result& result, const char* op) {
  std::size_t n = 0;
  for (const PassReport& pass : result.passes)
    if (pass.op == op) n += pass.winners;
  return n;
}

TEST(InterfacesProperty, SwapsAndCollapsesChangeBothSidesAndKeepTheirVolumes) {
  int n_swaps = 0;
  int n_collapses = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TetMesh mesh = halves(6, 0.4, seed);
    SurfaceMesh surface(mesh, with(SurfaceMode::kFlat).surface);
    ASSERT_TRUE(surface.has_interfaces());
    const auto before = region_volumes(mesh);
    const auto expect_sound = [&](double worst_before) {
      ASSERT_EQ(check(mesh), Ok);
      ASSERT_TRUE(surface.in_step(mesh));
      ASSERT_GE(worst(mesh), worst_before);
      for (const auto& [region, v] : region_volumes(mesh)) ASSERT_NEAR(v, before.at(region), 1e-14);
    };
    std::vector<std::array<VertexHandle, 2>> edges;
    for (EdgeHandle e : mesh.edges())
      if (!mesh.is_boundary(e)) edges.push_back(mesh.edge_vertices(e));
    for (const auto& [a, b] : edges) {
      const EdgeHandle e = mesh.find_edge(a, b);
      if (!e.is_valid() || !surface.may_swap(a, b)) continue;
      const auto quality = values(mesh);
      const double worst_before = worst(mesh);
      const auto plan = try_on(InterfaceSwap<VolumeLength>{{}, quality, &surface}, mesh, e);
      if (!plan) continue;
      ++n_swaps;
      surface.on_swap(plan->edge[0], plan->edge[1]);
      surface.write_labels(mesh);
      expect_sound(worst_before);
    }
    for (VertexHandle v : mesh.vertices()) {
      if (mesh.point(v).x != 0.5 || mesh.is_boundary(v)) continue;
      std::vector<VertexHandle> targets;
      surface.collapse_targets(v, targets);
      if (targets.empty()) continue;
      const auto quality = values(mesh);
      const double worst_before = worst(mesh);
      const SurfaceCollapse<VolumeLength> op{{}, quality, &surface, targets};
      const auto plan = try_on(op, mesh, {v, 0, static_cast<std::uint32_t>(targets.size())});
      if (!plan) continue;
      EXPECT_GT(plan->n_removed_first, 0U);
      ++n_collapses;
      surface.on_collapse(v, plan->onto);
      surface.write_labels(mesh);
      expect_sound(worst_before);
    }
  }
  EXPECT_GT(n_swaps, 20) << "the interfaces no longer have diagonals to swap";
  EXPECT_GT(n_collapses, 10) << "the interfaces no longer have vertices to collapse";
}

TEST(Interfaces, FlatKeepsThePlaneTheLabelsAndBothVolumes) {
  TetMesh mesh = halves(8, 0.4, 3);
  const auto before = region_volumes(mesh);
  ImproveOptions options = with(SurfaceMode::kFlat);
  options.raise_min_dihedral = true;
  const Result result = improve(mesh, options);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_GT(winners(result, "surface interface"), 5U);
  for (const auto& [region, v] : region_volumes(mesh)) EXPECT_NEAR(v, before.at(region), 1e-13);
  const auto faces = interface_of(mesh);
  double area = 0;
  for (const Triangle& t : faces) {
    for (Vec3 p : t) EXPECT_EQ(p.x, 0.5);
    area += 0.5 * norm(cross(t[1] - t[0], t[2] - t[0]));
  }
  EXPECT_NEAR(area, 1, 1e-13);
  std::size_t n_labelled = 0;
  for (const auto& entry : mesh.labels().faces.entries()) {
    const HalfFaceHandle h = mesh.find_halfface(entry.vertices);
    ASSERT_TRUE(h.is_valid());
    n_labelled += mesh.is_constrained(h) && entry.value == 7 && !mesh.is_boundary(h);
  }
  EXPECT_EQ(n_labelled, faces.size());
  ASSERT_EQ(result.surface.regions.size(), 2U);
  for (const RegionChange& r : result.surface.regions) {
    EXPECT_NEAR(r.before, before.at(r.region), 1e-14);
    EXPECT_NEAR(r.after, r.before, 1e-13);
  }
}

TEST(Interfaces, FreeMendsACurvedOneWithinItsDistance) {
  const TetMesh input = cored_ball(0.13, 2);
  TetMesh frozen = input;
  const Result kept = improve(frozen, with(SurfaceMode::kFrozen));
  TetMesh mesh = input;
  const Result result = improve(mesh, with(SurfaceMode::kFree));
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_TRUE(result.invalid_cells.empty());
  EXPECT_GT(winners(result, "surface interface"), 0U);
  EXPECT_GT(result.after.min_dihedral.min, kept.after.min_dihedral.min + 1);
  const double moved = surface_distance(interface_of(input), interface_of(mesh), 0.02).hausdorff();
  EXPECT_GT(moved, 0);
  EXPECT_LE(moved, 1.1 * result.surface.bound);
  const auto before = region_volumes(input);
  for (const auto& [region, v] : region_volumes(mesh)) EXPECT_NEAR(v / before.at(region), 1, 1e-3);
  // Every face of the interface has the core inside.
  for (const Triangle& t : interface_of(mesh)) EXPECT_GT(dot(cross(t[1] - t[0], t[2] - t[0]), t[0]), 0);
}

TEST(Interfaces, EveryNumberOfThreadsGivesTheSameBits) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    std::optional<std::uint64_t> first;
    for (const int threads : {1, 2, 3, 7}) {
      TetMesh mesh = mode == SurfaceMode::kFlat ? halves(6, 0.4, 2) : cored_ball(0.13, 4);
      ImproveOptions options = with(mode);
      options.policy = {threads, /*serial_below=*/1};
      options.statistics = false;
      const Result result = improve(mesh, options);
      EXPECT_GT(winners(result, "surface interface") + winners(result, "surface node"), 0U);
      EXPECT_EQ(check(mesh), Ok);
      const std::uint64_t hash = io::mesh_hash(mesh);
      if (!first) first = hash;
      EXPECT_EQ(hash, *first) << threads << " threads";
    }
  }
}

/// Whether what options.mode keeps leaves each cell less than `degrees`.
std::vector<bool> held_below(const TetMesh& mesh, const std::vector<CellHandle>& cells, double degrees,
                             const SurfaceOptions& options) {
  std::vector<bool> held;
  for (const FeatureCeiling& ceiling : feature_ceilings(mesh, cells, options))
    held.push_back(ceiling.degrees < degrees);
  return held;
}

TEST(Interfaces, NarrowEdgeHoldsTheCellsOnItsOwnSideOnly) {
  // Four cells round an edge; the first has 10 degrees there.
  const double half = 5 * std::numbers::pi / 180;
  for (const bool first_is_smaller : {true, false}) {
    TetMesh mesh = build({{-1, 0, 0},
                          {1, 0, 0},
                          {0, std::sin(half), std::cos(half)},
                          {0, -std::sin(half), std::cos(half)},
                          {0, -1, -0.5},
                          {0, 1, -0.5}},
                         std::vector<Corners>{{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 5}, {0, 1, 5, 2}});
    std::vector<CellHandle> cells;
    for (CellHandle c : mesh.cells()) {
      mesh.set_region(c, (c.idx() == 0) == first_is_smaller ? 1 : 2);
      cells.push_back(c);
    }
    SurfaceOptions options;
    options.mode = SurfaceMode::kFlat;
    const FeatureCeiling first = feature_ceilings(mesh, cells, options)[0];
    EXPECT_NEAR(first.degrees, 10, 1e-9);
    EXPECT_EQ(std::pair(first.a, first.b), std::pair(VertexHandle(0), VertexHandle(1)));
    EXPECT_EQ(held_below(mesh, cells, 15, options), (std::vector<bool>{true, false, false, false}));
    options.mode = SurfaceMode::kFree;  // the faces may tilt, and leave more
    options.feature_angle = 160;        // no edge of the boundary turns by that
    options.hausdorff = 0.01;
    EXPECT_EQ(held_below(mesh, cells, 15, options), std::vector<bool>(4, false));
  }
}

TEST(Interfaces, FrontOfACrackHoldsNoCell) {
  // Cells all round an edge, but that the last and the first have different vertices at one place.
  constexpr int kCells = 7;
  for (int turn = 0; turn < 40; ++turn) {
    std::vector<Vec3> points = {{-1, 0, 0}, {1, 0, 0}};
    std::vector<Corners> corners;
    for (int i = 0; i <= kCells; ++i) {
      const double at = 2 * std::numbers::pi * (i % kCells) / kCells + 0.1 * turn;
      points.push_back({0.1 * std::sin(at), std::cos(at), std::sin(at)});
      if (i < kCells) corners.push_back({0, 1, static_cast<Index>(i + 2), static_cast<Index>(i + 3)});
    }
    const TetMesh mesh = build(points, corners);
    std::vector<CellHandle> cells;
    for (CellHandle c : mesh.cells()) {
      const auto& v = mesh.cell(c).v;
      ASSERT_EQ(orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])), 1);
      cells.push_back(c);
    }
    SurfaceOptions options;
    options.mode = SurfaceMode::kFlat;
    EXPECT_EQ(held_below(mesh, cells, 15, options), std::vector<bool>(kCells, false)) << turn;
  }
}

}  // namespace
}  // namespace hfr::test
