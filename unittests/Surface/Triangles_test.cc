// SPDX-License-Identifier: BSD-3-Clause
// Surfaces without cells.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "HalfFace/Errors.hh"
#include "Remesh/ImproveTriangles.hh"
#include "Remesh/Meshes.hh"
#include "Surface/TriangleSweep.hh"

namespace hfr::test {
namespace {

TriangleOptions with(SurfaceMode mode) {
  TriangleOptions options;
  options.surface.mode = mode;
  options.policy = {};
  return options;
}

/// The boundary of a mesh of cells; label 1 + 2·axis + side on the sides of the unit cube, else 0.
TriangleMesh boundary_of(const TetMesh& mesh) {
  TriangleMesh surface;
  surface.points.assign(mesh.points().begin(), mesh.points().end());
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);
    surface.triangles.push_back({f[0], f[2], f[1]});
    int label = 0;
    for (int d = 0; d < 3; ++d)
      for (const double side : {0.0, 1.0})
        if (mesh.point(f[0])[d] == side && mesh.point(f[1])[d] == side && mesh.point(f[2])[d] == side)
          label = 1 + 2 * d + static_cast<int>(side);
    surface.patches.push_back(label);
  }
  return surface;
}

TriangleMesh jittered_cube() { return boundary_of(jittered(6, 0.3, 3)); }

/// A sheet over the unit square, bent when `bend` is not 0; its vertices are jittered along it.
TriangleMesh sheet(Index n, double bend) {
  TriangleMesh mesh;
  const auto at = [&](Index i, Index j) { return VertexHandle(j * (n + 1) + i); };
  const double h = 1.0 / static_cast<double>(n);
  for (Index j = 0; j <= n; ++j)
    for (Index i = 0; i <= n; ++i) {
      const std::uint64_t v = mesh.points.size();
      const auto shift = [&](Index k, std::uint64_t axis) {
        return k == 0 || k == n ? 0.0 : 0.3 * (2 * generate::random_unit(4, 2 * v + axis) - 1);
      };
      const double x = h * (static_cast<double>(i) + shift(i, 0));
      const double y = h * (static_cast<double>(j) + shift(j, 1));
      mesh.points.push_back({x, y, bend * std::sin(3 * x) * std::cos(2 * y)});
    }
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

std::map<int, double> patch_areas(const TriangleMesh& mesh) {
  std::map<int, double> areas;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Vec3 p = mesh.points[t[0].idx()];
    areas[mesh.patches[i]] += 0.5 * norm(cross(mesh.points[t[1].idx()] - p, mesh.points[t[2].idx()] - p));
  }
  return areas;
}

std::size_t winners(const TriangleResult& result, const std::string& op) {
  std::size_t n = 0;
  for (const PassReport& pass : result.passes)
    if (pass.op == op) n += pass.winners;
  return n;
}

TEST(Triangles, CubeKeepsPlanesCornersPatchesAndVolume) {
  for (const SurfaceMode mode : {SurfaceMode::kFlat, SurfaceMode::kFree}) {
    TriangleMesh mesh = jittered_cube();
    const auto areas = patch_areas(mesh);
    ASSERT_EQ(areas.size(), 6U);
    const TriangleResult result = improve_triangles(mesh, with(mode));
    EXPECT_GT(result.after.min_angle.min, 25);
    EXPECT_GT(result.after.min_angle.min, 2 * result.before.min_angle.min);
    EXPECT_NEAR(result.after.volume, 1, 1e-12);
    EXPECT_LT(result.surface.hausdorff, 1e-14);
    EXPECT_GT(winners(result, "surface swap"), 10U);
    EXPECT_GT(winners(result, "surface smooth"), 50U);
    const auto areas_after = patch_areas(mesh);
    ASSERT_EQ(areas_after.size(), 6U);
    for (const auto& [patch, area] : areas_after) EXPECT_NEAR(area, areas.at(patch), 1e-12);
    std::set<VertexHandle> corners;
    for (const auto& t : mesh.triangles)
      for (VertexHandle v : t) {
        int n_on = 0;
        for (int d = 0; d < 3; ++d) n_on += mesh.points[v.idx()][d] == 0 || mesh.points[v.idx()][d] == 1;
        EXPECT_GE(n_on, 1) << "a vertex has left its plane";
        if (n_on == 3) corners.insert(v);
      }
    EXPECT_EQ(corners.size(), 8U);
  }
}

TEST(Triangles, OpenSheetKeepsItsRimAndItsDistance) {
  TriangleMesh mesh = sheet(16, 0.3);
  TriangleOptions options = with(SurfaceMode::kFree);
  options.surface.hausdorff = 0.01;
  const TriangleResult result = improve_triangles(mesh, options);
  EXPECT_GT(result.after.min_angle.min, 25);
  EXPECT_LT(result.before.min_angle.min, 15);
  EXPECT_LE(result.surface.hausdorff, 0.0105);
  EXPECT_EQ(result.after.volume, 0) << "an open surface encloses nothing";
  EXPECT_EQ(result.after.non_manifold_edges, 0U);
  EXPECT_GT(result.after.open_edges, 32U);
  std::size_t n_corners = 0;
  for (const Vec3 p : mesh.points) n_corners += (p.x == 0 || p.x == 1) && (p.y == 0 || p.y == 1);
  EXPECT_EQ(n_corners, 4U);
}

TEST(Triangles, FlatSheetGetsNewTrianglesOfTheSameArea) {
  TriangleMesh mesh = sheet(12, 0);
  const TriangleResult result = improve_triangles(mesh, with(SurfaceMode::kFlat));
  EXPECT_GT(result.after.min_angle.min, 25);
  EXPECT_NEAR(result.after.area, 1, 1e-12);
  for (const Vec3 p : mesh.points) EXPECT_EQ(p.z, 0);
}

TEST(Triangles, EdgeOfThreeSheetsStays) {
  // Three pages that share a spine of four edges.
  TriangleMesh mesh = sheet(8, 0);
  const TriangleMesh page = mesh;
  for (const Vec3 axis : {Vec3{0, 0, 1}, Vec3{-1, 0, 0}}) {
    const auto n = static_cast<Index>(mesh.points.size());
    for (const Vec3 p : page.points) mesh.points.push_back({axis.x * p.x, p.y, axis.z * p.x});
    for (auto t : page.triangles) {
      for (VertexHandle& v : t) v = page.points[v.idx()].x == 0 ? v : VertexHandle(v.idx() + n);
      mesh.triangles.push_back(t);
    }
  }
  const std::size_t n_spine = statistics(mesh).non_manifold_edges;
  ASSERT_EQ(n_spine, 8U);
  const auto on_spine = [](const TriangleMesh& m) {
    std::set<double> places;
    for (const auto& t : m.triangles)
      for (VertexHandle v : t)
        if (m.points[v.idx()].x == 0 && m.points[v.idx()].z == 0) places.insert(m.points[v.idx()].y);
    return places;
  };
  const std::set<double> before = on_spine(mesh);
  const TriangleResult result = improve_triangles(mesh, with(SurfaceMode::kFree));
  EXPECT_TRUE(result.changed);
  EXPECT_EQ(result.after.non_manifold_edges, n_spine);
  EXPECT_EQ(on_spine(mesh), before);
  EXPECT_GT(result.after.min_angle.percentiles[2], result.before.min_angle.percentiles[2]);
}

TEST(Triangles, FixedPatchKeepsEveryBit) {
  TriangleMesh mesh = jittered_cube();
  const auto patch = [](const TriangleMesh& m, int label) {
    std::set<std::array<std::array<double, 3>, 3>> faces;
    for (std::size_t i = 0; i < m.triangles.size(); ++i) {
      if (m.patches[i] != label) continue;
      std::array<std::array<double, 3>, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = m.points[m.triangles[i][k].idx()];
        corners[k] = {p.x, p.y, p.z};
      }
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      faces.insert(corners);
    }
    return faces;
  };
  const auto kept = patch(mesh, 2);
  const auto other = patch(mesh, 4);
  TriangleOptions options = with(SurfaceMode::kFlat);
  options.surface.fixed_patches = {2};
  const TriangleResult result = improve_triangles(mesh, options);
  EXPECT_EQ(patch(mesh, 2), kept);
  EXPECT_NE(patch(mesh, 4), other) << "nothing has changed anywhere";
  ASSERT_GT(result.vertex_map.size(), 0U);
}

TEST(Triangles, GoalThatIsMetChangesNothing) {
  TriangleMesh mesh = sheet(6, 0.2);
  const TriangleMesh before = mesh;
  TriangleOptions options = with(SurfaceMode::kFree);
  options.min_angle = 0.5 * statistics(mesh).min_angle.min;
  const TriangleResult result = improve_triangles(mesh, options);
  EXPECT_FALSE(result.changed);
  EXPECT_TRUE(result.goal_reached);
  EXPECT_EQ(mesh.points, before.points);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(Triangles, GoalOutOfReachIsMissedHonestly) {
  TriangleMesh mesh = sheet(6, 0.2);
  TriangleOptions options = with(SurfaceMode::kFree);
  options.min_angle = 59;
  const TriangleResult result = improve_triangles(mesh, options);
  EXPECT_FALSE(result.goal_reached);
  EXPECT_GE(result.after.min_angle.min, result.before.min_angle.min);
}

TEST(Triangles, EveryPassKeepsTheWorstAndTheSurfaceInStep) {
  const TriangleMesh mesh = sheet(14, 0.4);
  SurfaceMesh surface(mesh, with(SurfaceMode::kFree).surface);
  TriangleSweep sweep(surface);
  std::size_t changes = 0;
  double worst = sweep.worst();
  sweep.focus(0.3);
  for (int i = 0; i < 3; ++i)
    for (const auto pass :
         {&TriangleSweep::split, &TriangleSweep::swap, &TriangleSweep::collapse, &TriangleSweep::smooth}) {
      changes += (sweep.*pass)();
      EXPECT_GE(sweep.worst(), worst);
      worst = sweep.worst();
      for (std::size_t f = 0; f < surface.n_faces(); ++f) {
        if (surface.is_deleted(f)) continue;
        for (VertexHandle v : surface.face_vertices(f)) EXPECT_EQ(surface.point(v), sweep.points()[v.idx()]);
      }
    }
  EXPECT_GT(changes, 100U);
}

double area_of(const TriangleMesh& mesh, const auto& counts) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 p = mesh.points[t[0].idx()];
    const Vec3 n = cross(mesh.points[t[1].idx()] - p, mesh.points[t[2].idx()] - p);
    if (counts(n)) sum += 0.5 * norm(n);
  }
  return sum;
}

/// Its two sides are nearer to each other than a surface may go: for a triangle that turns over the other one
/// is there and looks the way that it does.
TEST(Triangles, ThinPlateIsNotFoldedOver) {
  TriangleMesh plate;
  for (const double z : {0.0, -0.01})
    for (const Vec3 p : {Vec3{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {2, -1, 0}, {3, 0, 0}})
      plate.points.push_back({p.x, p.y, z});
  const auto add = [&](int a, int b, int c) {
    plate.triangles.push_back({VertexHandle(a), VertexHandle(b), VertexHandle(c)});
  };
  for (const auto& [a, b, c] : std::vector<std::array<int, 3>>{{0, 1, 2}, {1, 0, 3}, {1, 3, 4}, {1, 4, 2}}) {
    add(a, b, c);
    add(a + 5, c + 5, b + 5);
  }
  for (const auto& [a, b] : std::vector<std::array<int, 2>>{{0, 3}, {3, 4}, {4, 2}, {2, 0}}) {
    add(a, a + 5, b);
    add(b, a + 5, b + 5);
  }
  const auto looks_up = [](Vec3 n) { return n.z > 0.5 * norm(n); };
  const double before = area_of(plate, looks_up);
  TriangleMesh mesh = plate;
  improve_triangles(mesh, with(SurfaceMode::kFree));
  EXPECT_NEAR(area_of(mesh, looks_up), before, 0.02 * before);
}

/// Two planes at 20 degrees. A triangle that turns over in one looks about the way that the other does.
TEST(Triangles, FacetsAtASharpEdgeAreNotFoldedOver) {
  TriangleMesh wedge;
  const double angle = 20 * 3.14159265358979 / 180;
  const auto in_b = [&](double x, double y) { return Vec3{x, y * std::cos(angle), y * std::sin(angle)}; };
  wedge.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0.5, 1, 0}, {1.5, 0.1, 0}, in_b(0.8, 1), in_b(1.6, 0.03)};
  for (const auto& [a, b, c] :
       std::vector<std::array<int, 3>>{{1, 2, 4}, {1, 4, 3}, {1, 3, 0}, {1, 6, 2}, {1, 5, 6}, {1, 0, 5}})
    wedge.triangles.push_back({VertexHandle(a), VertexHandle(b), VertexHandle(c)});
  const auto all = [](Vec3) { return true; };
  for (const double goal : {5.0, 30.0}) {
    TriangleMesh mesh = wedge;
    TriangleOptions options = with(SurfaceMode::kFlat);
    options.min_angle = goal;
    const TriangleResult result = improve_triangles(mesh, options);
    EXPECT_NEAR(area_of(mesh, all), area_of(wedge, all), 1e-9) << goal;
    EXPECT_GE(result.after.min_angle.min, result.before.min_angle.min);
  }
}

/// The sides of such an edge differ in size: the smaller one is not taken for turned over.
TEST(Triangles, VerticesOnASharpEdgeMove) {
  TriangleMesh wedge;
  const double angle = 20 * 3.14159265358979 / 180;
  wedge.points = {
      {0, 0, 0}, {0.1, 0, 0}, {2, 0, 0}, {1, 3, 0}, {1, 0.8 * std::cos(angle), 0.8 * std::sin(angle)}};
  for (const auto& [a, b, c] : std::vector<std::array<int, 3>>{{0, 1, 3}, {1, 2, 3}, {1, 0, 4}, {2, 1, 4}})
    wedge.triangles.push_back({VertexHandle(a), VertexHandle(b), VertexHandle(c)});
  SurfaceMesh surface(wedge, with(SurfaceMode::kFlat).surface);
  ASSERT_EQ(surface.motion_constraint(VertexHandle(1)).kind, SurfaceKind::kCurve);
  TriangleSweep sweep(surface);
  sweep.focus(1);
  EXPECT_EQ(sweep.smooth(), 1U);
  EXPECT_GT(sweep.points()[1].x, 0.3);
}

TEST(Triangles, PointsThatNoTriangleHasStay) {
  TriangleMesh mesh = sheet(6, 0.4);
  const std::size_t n = mesh.points.size();
  mesh.points.push_back({7, 7, 7});
  mesh.points.push_back({8, 8, 8});
  const TriangleResult result = improve_triangles(mesh, with(SurfaceMode::kFree));
  ASSERT_GT(winners(result, "surface split"), 0U);
  for (const std::size_t i : {n, n + 1}) {
    const VertexHandle now = result.vertex_map[i];
    if (!now.is_valid()) continue;  // not kept, and taken by no other
    EXPECT_EQ(mesh.points[now.idx()].x, static_cast<double>(7 + i - n));
    for (const auto& t : mesh.triangles) EXPECT_EQ(std::find(t.begin(), t.end(), now), t.end());
  }
}

TEST(Triangles, RefusesWhatItCannotDo) {
  TriangleMesh mesh = sheet(3, 0);
  EXPECT_THROW(improve_triangles(mesh, with(SurfaceMode::kFrozen)), InvalidInput);
  TriangleOptions options = with(SurfaceMode::kFlat);
  options.min_angle = 60;
  EXPECT_THROW(improve_triangles(mesh, options), InvalidInput);
  TriangleMesh broken = mesh;
  broken.triangles[3][1] = VertexHandle(99);
  EXPECT_THROW(improve_triangles(broken, with(SurfaceMode::kFlat)), InvalidInput);
  broken.triangles[3][1] = broken.triangles[3][0];
  EXPECT_THROW(improve_triangles(broken, with(SurfaceMode::kFlat)), InvalidInput);
}

TEST(Triangles, FixedPartsThatAreNotThereAreRefused) {
  const auto refuses = [](const std::function<void(SurfaceOptions&)>& set) {
    TriangleMesh mesh = sheet(2, 0);
    mesh.patches.assign(mesh.triangles.size(), 1);
    TriangleOptions options = with(SurfaceMode::kFlat);
    set(options.surface);
    try {
      improve_triangles(mesh, options);
    } catch (const InvalidInput&) {
      return true;
    }
    return false;
  };
  const VertexHandle a(0), b(1), c(4), far(99);
  EXPECT_TRUE(refuses([&](SurfaceOptions& o) { o.fixed_vertices = {far}; }));
  EXPECT_TRUE(refuses([&](SurfaceOptions& o) { o.fixed_edges = {{a, VertexHandle(8)}}; }));
  EXPECT_TRUE(refuses([&](SurfaceOptions& o) { o.fixed_faces = {{a, b, VertexHandle(8)}}; }));
  EXPECT_TRUE(refuses([&](SurfaceOptions& o) { o.fixed_patches = {77}; }));
  EXPECT_FALSE(refuses([&](SurfaceOptions& o) {
    o.fixed_vertices = {a};
    o.fixed_edges = {{b, a}};
    o.fixed_faces = {{c, a, b}};
    o.fixed_patches = {1};
  }));
}

TEST(Triangles, EmptySurfaceIsLeftAlone) {
  TriangleMesh mesh;
  EXPECT_FALSE(improve_triangles(mesh, with(SurfaceMode::kFree)).changed);
}

}  // namespace
}  // namespace hfr::test
