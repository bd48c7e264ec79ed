// SPDX-License-Identifier: BSD-3-Clause
#include "Surface/PlanarUnfold.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include "Remesh/Improve.hh"
#include "Surface/Meshes.hh"
#include "Surface/SurfaceMesh.hh"

namespace hfr::test {
namespace {

/// A box of 8 x 8 x 2 cubes, the side of one of them 1, without the four cubes in the middle.
TetMesh framed() {
  const generate::Arrays box = generate::box({8, 8, 2}, {0, 0, 0}, {8, 8, 2});
  std::vector<std::array<Index, 4>> cells;
  for (const auto& t : box.cells) {
    Vec3 middle;
    for (Index v : t) middle = middle + 0.25 * box.points[v];
    if (std::max(std::abs(middle.x - 4), std::abs(middle.y - 4)) > 1) cells.push_back(t);
  }
  TetMesh mesh = build(box.points, cells);
  mesh.collect_garbage({.drop_unused_vertices = true});
  return mesh;
}

/// The hole moves; what is not next to it stays, so that both walls fold over, and over its rim.
TetMesh with_moved_hole(double by) {
  TetMesh mesh = framed();
  for (VertexHandle v : mesh.vertices()) {
    Vec3 p = mesh.point(v);
    if (std::max(std::abs(p.x - 4), std::abs(p.y - 4)) > 1.01) continue;
    p.x += by;
    mesh.set_point(v, p);
  }
  return mesh;
}

/// Triangles of the walls z = 0 and z = 2 that look into the mesh or have no area.
std::size_t n_turned(const TetMesh& mesh) {
  std::size_t n = 0;
  for (const Triangle& t : surface_triangles(mesh)) {
    if (!(t[0].z == t[1].z && t[1].z == t[2].z)) continue;
    const double area = cross(t[1] - t[0], t[2] - t[0]).z;
    if (!((t[0].z > 1 ? area : -area) > 0)) ++n;
  }
  return n;
}

/// Of a place before the hole moved.
bool is_on_rim(Vec3 p) {
  return std::max(std::abs(p.x - 4), std::abs(p.y - 4)) < 1.01 || p.x == 0 || p.y == 0 || p.x == 8 ||
         p.y == 8;
}

TEST(PlanarUnfold, OpensWallsThatAreFoldedOverTheRimOfAHole) {
  for (double by : {1.5, 2.0, 2.5}) {
    const TetMesh before = framed(), folded = with_moved_hole(by);
    ASSERT_GT(n_turned(folded), 0U) << by;
    TetMesh mesh = folded;
    const PlanarUnfolding done = unfold_planes(mesh, flat_surface());
    EXPECT_EQ(done.n_folded, n_turned(folded)) << by;
    EXPECT_EQ(done.n_left, 0U) << by;
    EXPECT_EQ(n_turned(mesh), 0U) << by;
    std::size_t n_moved = 0;
    for (VertexHandle v : folded.vertices()) {
      const Vec3 p = folded.point(v), q = mesh.point(v);
      EXPECT_EQ(p.z, q.z);
      if (p.z == 1 || is_on_rim(before.point(v))) {
        EXPECT_EQ(p, q);
      }
      n_moved += p == q ? 0 : 1;
    }
    EXPECT_EQ(n_moved, done.n_moved) << by;
    EXPECT_GT(n_moved, 0U) << by;
  }
}

/// A box of cubes whose lid has come down past vertices that stayed.
TetMesh with_lowered_lid(double to) {
  TetMesh mesh = built(generate::box({4, 4, 8}, {0, 0, 0}, {4, 4, 8}));
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    if (p.z == 8) mesh.set_point(v, {p.x, p.y, to});
  }
  return mesh;
}

TEST(PlanarUnfold, VerticesOnStraightEdgesThatALidHasPassedComeBackBelowIt) {
  for (double to : {6.5, 5.0, 2.25}) {
    const TetMesh before = with_lowered_lid(8), folded = with_lowered_lid(to);
    TetMesh mesh = folded;
    const PlanarUnfolding done = unfold_planes(mesh, flat_surface());
    EXPECT_GT(done.n_folded, 0U) << to;
    EXPECT_EQ(done.n_left, 0U) << to;
    std::size_t n_moved = 0;
    for (VertexHandle v : mesh.vertices()) {
      const Vec3 p = folded.point(v), q = mesh.point(v);
      const auto is_side = [](double x) { return x == 0 || x == 4; };
      n_moved += p == q ? 0 : 1;
      const double z = before.point(v).z;
      if (z == 0 || z == 8 || !(is_side(p.x) || is_side(p.y))) {
        EXPECT_EQ(p, q);
        continue;
      }
      EXPECT_LT(q.z, to);
      if (is_side(p.x)) {
        EXPECT_EQ(q.x, p.x);
      }
      if (is_side(p.y)) {
        EXPECT_EQ(q.y, p.y);
      }
    }
    EXPECT_EQ(n_moved, done.n_moved) << to;
    // What lies far from the lid stays.
    for (VertexHandle v : mesh.vertices())
      if (folded.point(v).z == 1 && to > 6) {
        EXPECT_EQ(mesh.point(v), folded.point(v));
      }
    const Result result = improve(mesh, with(SurfaceMode::kFlat));
    EXPECT_EQ(result.after.inverted.size() + result.after.flat.size(), 0U) << to;
    EXPECT_NEAR(result.after.enclosed_volume, 16 * to, 1e-9);
  }
}

TEST(PlanarUnfold, AFixedVertexEndsAnEdge) {
  const TetMesh folded = with_lowered_lid(6.5);
  SurfaceOptions options = flat_surface();
  for (VertexHandle v : folded.vertices())
    if (const Vec3 p = folded.point(v); p.x == 0 && p.y == 0 && p.z == 7) options.fixed_vertices = {v};
  ASSERT_EQ(options.fixed_vertices.size(), 1U);
  TetMesh mesh = folded;
  const PlanarUnfolding done = unfold_planes(mesh, options);
  EXPECT_GT(done.n_left, 0U);  // the edge cannot open there
  EXPECT_LT(done.n_left, done.n_folded);
  EXPECT_EQ(mesh.point(options.fixed_vertices[0]), folded.point(options.fixed_vertices[0]));
}

TEST(PlanarUnfold, ATiltedWallStaysInItsPlane) {
  TetMesh mesh = with_moved_hole(2);
  const Vec3 x = {2.0 / 3, 2.0 / 3, 1.0 / 3}, y = {-2.0 / 3, 1.0 / 3, 2.0 / 3}, z = cross(x, y);
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v);
    mesh.set_point(v, (p.x * x + p.y * y) + p.z * z);
  }
  const TetMesh folded = mesh;
  const PlanarUnfolding done = unfold_planes(mesh, flat_surface());
  EXPECT_GT(done.n_folded, 0U);
  EXPECT_EQ(done.n_left, 0U);
  for (VertexHandle v : mesh.vertices()) EXPECT_NEAR(dot(mesh.point(v), z), dot(folded.point(v), z), 1e-14);
}

TEST(PlanarUnfold, AFoldThatWhatIsHeldLeavesNoRoomStays) {
  const TetMesh folded = with_moved_hole(2);
  SurfaceOptions options = flat_surface();
  for (VertexHandle v : folded.vertices())
    if (folded.point(v).z == 2) options.fixed_vertices.push_back(v);
  TetMesh mesh = folded;
  const PlanarUnfolding done = unfold_planes(mesh, options);
  EXPECT_EQ(done.n_folded, n_turned(folded));
  EXPECT_EQ(done.n_left, done.n_folded / 2);  // both walls have the same
  EXPECT_EQ(n_turned(mesh), done.n_left);
  for (VertexHandle v : options.fixed_vertices) EXPECT_EQ(mesh.point(v), folded.point(v));
}

TEST(PlanarUnfold, VerticesStayOnTheirSideOfABorderOfLabels) {
  const TetMesh folded = with_moved_hole(2);
  const TetMesh before = framed();
  TetMesh mesh = folded;
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);
    const auto is_on_top = [&](VertexHandle v) { return before.point(v).z == 2; };
    const auto is_near = [&](VertexHandle v) { return before.point(v).y <= 4; };
    if (std::ranges::all_of(f, is_on_top))
      mesh.labels().faces.set(f, std::ranges::all_of(f, is_near) ? 7 : 8);
  }
  const PlanarUnfolding done = unfold_planes(mesh, flat_surface());
  EXPECT_EQ(done.n_left, 0U);
  EXPECT_EQ(n_turned(mesh), 0U);
  std::size_t n_on_seam = 0;
  for (VertexHandle v : before.vertices()) {
    const Vec3 p = before.point(v), q = mesh.point(v);
    if (p.z != 2) continue;
    if (p.y == 4) {  // the border of the label is straight: vertices slide along it
      EXPECT_EQ(q.y, 4);
      ++n_on_seam;
    } else if (!is_on_rim(p)) {
      EXPECT_EQ(q.y < 4, p.y < 4);
    }
  }
  EXPECT_EQ(n_on_seam, 8U);
}

/// A block on a wider one, all of it one region, that stands free from x = 3 to its end at x = 6.
TetMesh slitted() {
  const generate::Arrays box = generate::box({8, 4, 2}, {0, 0, 0}, {8, 4, 2});
  std::vector<Vec3> points = box.points;
  std::vector<std::array<Index, 4>> cells;
  std::map<Index, Index> doubled;
  for (auto t : box.cells) {
    Vec3 middle;
    for (Index v : t) middle = middle + 0.25 * box.points[v];
    if (middle.z > 1 && middle.x > 6) continue;
    for (Index& v : t) {
      if (!(middle.z > 1 && box.points[v].z == 1 && box.points[v].x > 3)) continue;
      const auto [at, is_new] = doubled.try_emplace(v, static_cast<Index>(points.size()));
      if (is_new) points.push_back(box.points[v]);
      v = at->second;
    }
    cells.push_back(t);
  }
  TetMesh mesh = build(points, cells);
  mesh.collect_garbage({.drop_unused_vertices = true});
  return mesh;
}

TEST(PlanarUnfold, TheSidesOfASlitAreNoFold) {
  for (SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TetMesh mesh = slitted();
    SurfaceOptions options;
    options.mode = mode;
    const PlanarUnfolding done = unfold_planes(mesh, options);
    EXPECT_EQ(done.n_folded, 0U);
    EXPECT_EQ(done.n_moved, 0U);
  }
}

TEST(PlanarUnfold, ASlitStaysBesideAFoldThatOpens) {
  TetMesh folded = slitted();
  for (VertexHandle v : folded.vertices())
    if (folded.point(v) == Vec3{7, 2, 1}) folded.set_point(v, {5.6, 2, 1});
  TetMesh mesh = folded;
  const PlanarUnfolding done = unfold_planes(mesh, flat_surface());
  EXPECT_GT(done.n_folded, 0U);
  EXPECT_EQ(done.n_left, 0U);
  EXPECT_GT(done.n_moved, 0U);
  for (CellHandle c : mesh.cells()) {
    for (VertexHandle v : mesh.cell(c).v) {
      const bool is_above =
          std::ranges::any_of(mesh.cell(c).v, [&](VertexHandle w) { return mesh.point(w).z == 2; });
      if (is_above) {
        EXPECT_EQ(mesh.point(v), folded.point(v));
      }
    }
  }
}

TEST(PlanarUnfold, AFoldOpensBesideOneThatCannot) {
  TetMesh folded = built(generate::box({8, 8, 2}, {0, 0, 0}, {8, 8, 2}));
  SurfaceOptions options = flat_surface();
  for (VertexHandle v : folded.vertices()) {
    const Vec3 p = folded.point(v);
    if (p == Vec3{2, 4, 2}) folded.set_point(v, {3.4, 4, 2});
    if (p == Vec3{6, 4, 2}) folded.set_point(v, {4.6, 4, 2});
    if (p.z == 2 && std::abs(p.x - 6) <= 1 && std::abs(p.y - 4) <= 1) options.fixed_vertices.push_back(v);
  }
  TetMesh mesh = folded;
  const PlanarUnfolding done = unfold_planes(mesh, options);
  EXPECT_GT(done.n_left, 0U);
  EXPECT_EQ(done.n_left, done.n_folded / 2);
  EXPECT_EQ(n_turned(mesh), done.n_left);
  for (VertexHandle v : options.fixed_vertices) EXPECT_EQ(mesh.point(v), folded.point(v));
}

TEST(PlanarUnfold, OfTwoLidsTheOneThatCannotOpenStaysAsItIs) {
  TetMesh folded = built(generate::box({4, 4, 12}, {0, 0, 0}, {4, 4, 12}));
  SurfaceOptions options = flat_surface();
  for (VertexHandle v : folded.vertices()) {
    const Vec3 p = folded.point(v);
    if (p.z == 0) folded.set_point(v, {p.x, p.y, 1.5});
    if (p.z == 12) folded.set_point(v, {p.x, p.y, 10.5});
    if (p.z > 0 && p.z < 3) options.fixed_vertices.push_back(v);
  }
  TetMesh mesh = folded;
  const PlanarUnfolding done = unfold_planes(mesh, options);
  EXPECT_EQ(done.n_left, done.n_folded / 2);
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = folded.point(v), q = mesh.point(v);
    if (p.z <= 3) {
      EXPECT_EQ(q, p);
    } else {
      EXPECT_LE(q.z, p.x > 0 && p.x < 4 && p.y > 0 && p.y < 4 ? 11 : 10.5);
    }
  }
}

TEST(PlanarUnfold, AStopOnTheWayLeavesWallsThatAreOpenOrAsTheyWere) {
  const TetMesh folded = with_lowered_lid(5);
  std::size_t n_asked = 0;
  TetMesh whole = folded;
  unfold_planes(whole, flat_surface(), {}, [&] { return ++n_asked == 0; });
  ASSERT_GT(n_asked, 20U);
  for (std::size_t last = 1; last < n_asked; last += n_asked / 20) {
    TetMesh mesh = folded;
    std::size_t n = 0;
    const PlanarUnfolding done = unfold_planes(mesh, flat_surface(), {}, [&] { return ++n >= last; });
    EXPECT_LE(done.n_left, done.n_folded) << last;
    std::size_t n_moved = 0;
    for (VertexHandle v : mesh.vertices()) n_moved += mesh.point(v) == folded.point(v) ? 0 : 1;
    EXPECT_EQ(n_moved, done.n_moved) << last;
  }
}

TEST(PlanarUnfold, DoesNothingWhereNothingMayChangeOrIsFolded) {
  TetMesh frozen = with_moved_hole(2), sound = framed(), stopped = with_moved_hole(2);
  EXPECT_EQ(unfold_planes(frozen, SurfaceOptions{}).n_folded, 0U);
  const PlanarUnfolding none = unfold_planes(sound, flat_surface());
  EXPECT_EQ(none.n_folded, 0U);
  EXPECT_EQ(none.n_moved, 0U);
  const PlanarUnfolding ended = unfold_planes(stopped, flat_surface(), {}, [] { return true; });
  EXPECT_EQ(ended.n_left, ended.n_folded);
  EXPECT_EQ(ended.n_moved, 0U);
}

TEST(PlanarUnfold, ARunMendsAllAndMeasuresAgainstWhatTheLayersAddUpTo) {
  for (SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TetMesh mesh = with_moved_hole(2);
    const Result result = improve(mesh, with(mode));
    EXPECT_EQ(result.after.inverted.size() + result.after.flat.size(), 0U);
    EXPECT_GT(result.after.min_dihedral.min, 30);
    EXPECT_GT(surface_changes(result), 0U);
    EXPECT_LE(result.surface.hausdorff, std::max(result.surface.bound, 1e-12));
    if (mode == SurfaceMode::kFlat) {
      EXPECT_NEAR(result.after.enclosed_volume, 120, 1e-9);
    }
  }
}

}  // namespace
}  // namespace hfr::test
