// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Generate.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "HalfFace/Errors.hh"
#include "HalfFace/TetMesh.hh"

namespace hfr::generate {
namespace {

double volume(const Arrays& mesh, std::size_t c) {
  const auto& v = mesh.cells[c];
  const Vec3 a = mesh.points[v[0]];
  return dot(mesh.points[v[1]] - a, cross(mesh.points[v[2]] - a, mesh.points[v[3]] - a)) / 6;
}

double total_volume(const Arrays& mesh) {
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) sum += volume(mesh, c);
  return sum;
}

std::size_t n_not_positive(const Arrays& mesh) {
  std::size_t n = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) n += volume(mesh, c) > 0 ? 0 : 1;
  return n;
}

/// Smallest and largest dihedral angle of a mesh, degrees.
std::pair<double, double> dihedral_range(const Arrays& mesh) {
  double low = 180, high = 0;
  for (const auto& v : mesh.cells) {
    for (std::size_t e = 0; e < 6; ++e) {
      const Vec3 a = mesh.points[v[kEdgeCorners[e][0]]];
      const Vec3 axis = mesh.points[v[kEdgeCorners[e][1]]] - a;
      const Vec3 m = cross(axis, mesh.points[v[kEdgeOpposite[e][0]]] - a);
      const Vec3 n = cross(axis, mesh.points[v[kEdgeOpposite[e][1]]] - a);
      const double angle = std::atan2(norm(cross(m, n)), dot(m, n)) * 180 / std::numbers::pi;
      low = std::min(low, angle);
      high = std::max(high, angle);
    }
  }
  return {low, high};
}

/// Every generated mesh has to be one that build() takes as it is, with every vertex in use.
void expect_conforming(const Arrays& mesh) {
  BuildReport report;
  const TetMesh built = build(mesh.points, mesh.cells, {}, &report);
  EXPECT_FALSE(report.flipped);
  EXPECT_TRUE(report.reoriented.empty());
  for (std::size_t v = 0; v < built.n_vertices(); ++v)
    ASSERT_TRUE(built.incident_cell(VertexHandle(v)).is_valid()) << "vertex " << v << " is in no cell";
}

std::size_t n_boundary_faces(const Arrays& mesh) {
  const TetMesh built = build(mesh.points, mesh.cells);
  std::size_t n = 0;
  for (std::size_t h = 0; h < 4 * built.n_cells(); ++h)
    n += built.opposite_halfface(HalfFaceHandle(h)).is_valid() ? 0 : 1;
  return n;
}

TEST(Generate, BoxNumbersItsVerticesRowByRow) {
  const Arrays mesh = box({2, 3, 4}, {-1, 0, 10}, {1, 6, 14});
  ASSERT_EQ(mesh.points.size(), 60U);
  EXPECT_EQ(mesh.cells.size(), 144U);
  EXPECT_EQ(mesh.points[(2 * 4 + 1) * 3 + 1], (Vec3{0, 2, 12}));
  EXPECT_EQ(mesh.points.back(), (Vec3{1, 6, 14}));
  EXPECT_TRUE(mesh.regions.empty());
  EXPECT_EQ(n_not_positive(mesh), 0U);
  EXPECT_NEAR(total_volume(mesh), 48, 1e-12);
  EXPECT_EQ(n_boundary_faces(mesh), 2U * 2 * (2 * 3 + 3 * 4 + 4 * 2));
  expect_conforming(mesh);
}

TEST(Generate, BoxRefusesNoCubesReversedCornersAndTooManyCells) {
  EXPECT_THROW(box({0, 1, 1}), InvalidInput);
  EXPECT_THROW(box({1, 1, 1}, {0, 0, 0}, {1, 0, 1}), InvalidInput);
  EXPECT_THROW(box({1, 1, 1}, {0, 0, std::nan("")}), InvalidInput);
#ifndef HFR_INDEX64
  EXPECT_THROW(box({100000, 100000, 1000}), ResourceLimit);
#endif
}

TEST(Generate, JitterMovesInnerCoordinatesOnly) {
  const Arrays straight = box({3, 3, 3});
  const Arrays mesh = jittered_box({3, 3, 3}, 0.2, 7);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    for (int d = 0; d < 3; ++d) {
      const double x = straight.points[v][d];
      if (x == 0 || x == 1) {
        EXPECT_EQ(mesh.points[v][d], x);
      }
      if (mesh.points[v][d] != x) ++moved;
      EXPECT_LE(std::abs(mesh.points[v][d] - x), 0.2 / 3);
    }
  EXPECT_EQ(moved, 3U * 2 * 16);
  EXPECT_EQ(mesh.points, jittered_box({3, 3, 3}, 0.2, 7).points);
  EXPECT_NE(mesh.points, jittered_box({3, 3, 3}, 0.2, 8).points);
}

TEST(Generate, TwoRegionBoxHasItsInterfaceInTheMiddle) {
  const Arrays mesh = two_region_box({4, 2, 3});
  ASSERT_EQ(mesh.regions.size(), mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (Index v : mesh.cells[c]) {
      if (mesh.regions[c] == 1) {
        EXPECT_LE(mesh.points[v].x, 0.5);
      }
      if (mesh.regions[c] == 2) {
        EXPECT_GE(mesh.points[v].x, 0.5);
      }
    }
  EXPECT_EQ(std::count(mesh.regions.begin(), mesh.regions.end(), 1), 72);
  EXPECT_THROW(two_region_box({1, 2, 2}), InvalidInput);
}

TEST(Generate, CavityDefaultsAreTheReferenceMeshBitForBit) {
  const std::filesystem::path path = std::filesystem::path(HFR_TEST_MESHES) / "cavity" / "cavity20k.mesh";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Arrays mesh = cavity();
  std::ifstream file(path);
  std::string word;
  std::size_t n = 0;
  while (file >> word && word != "Vertices") continue;
  file >> n;
  ASSERT_EQ(n, mesh.points.size());
  for (const Vec3& p : mesh.points) {
    Vec3 q;
    std::string label;
    file >> q.x >> q.y >> q.z >> label;
    ASSERT_EQ(q, p);
  }
  file >> word >> n;
  ASSERT_EQ(n, mesh.cells.size());
  for (const auto& cell : mesh.cells)
    for (std::size_t k = 0; k < 5; ++k) {
      Index v = 0;
      file >> v;
      if (k < 4) {
        ASSERT_EQ(v, cell[k] + 1);
      }
    }
  std::size_t inverted = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) inverted += volume(mesh, c) < 0 ? 1 : 0;
  EXPECT_EQ(inverted, 48U);
  expect_conforming(mesh);
}

TEST(Generate, KuhnTwinOfThePaperHas48InvertedCellsAndHadNoneBefore) {
  CavityOptions options;
  options.counts = {44, 46, 50};
  options.jitter = 0.201;
  options.sigma = 0.08;
  options.amplitude = 0;
  const Arrays before = cavity(options);
  EXPECT_EQ(before.cells.size(), 607200U);
  EXPECT_EQ(n_not_positive(before), 0U);
  EXPECT_NEAR(dihedral_range(before).first, 7.2607, 5e-5);
  options.amplitude = 0.27877;
  EXPECT_EQ(n_not_positive(cavity(options)), 48U);
}

TEST(Generate, DeformationLeavesTheSurfaceOfTheCubeAlone) {
  for (const CavityField field : {CavityField::kGaussians, CavityField::kBulkShear}) {
    CavityOptions options;
    options.counts = {6, 7, 8};
    options.jitter = 0.1;
    options.amplitude = 0;
    options.field = field;
    const Arrays before = cavity(options);
    options.amplitude = 0.1;
    const Arrays after = cavity(options);
    std::size_t inside = 0;
    for (std::size_t v = 0; v < before.points.size(); ++v) {
      const Vec3 p = before.points[v];
      bool on_surface = false;
      for (int d = 0; d < 3; ++d) on_surface = on_surface || p[d] == 0 || p[d] == 1;
      if (on_surface) {
        ASSERT_EQ(std::memcmp(&p, &after.points[v], sizeof p), 0);
      }
      if (!on_surface && after.points[v] != p) ++inside;
    }
    EXPECT_EQ(inside, 5U * 6 * 7);
  }
}

TEST(Generate, BulkShearFollowsItsFormula) {
  CavityOptions options;
  options.field = CavityField::kBulkShear;
  options.amplitude = 0.1;
  const Vec3 p = deform({0.25, 0.125, 0.75}, options);
  const double s = std::sin(std::numbers::pi / 8) * std::sin(std::numbers::pi / 8);
  EXPECT_NEAR(p.x, 0.25 - 0.1 * 2 * 0.5 * std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(p.y, 0.125 + 0.1 * s, 1e-15);
  EXPECT_NEAR(p.z, 0.75 - 0.1 * std::sqrt(0.5) * 0.5, 1e-15);
}

TEST(Generate, CavityRefusesAWidthOfZero) {
  CavityOptions options;
  options.sigma = 0;
  EXPECT_THROW(cavity(options), InvalidInput);
}

TEST(Generate, InnerJitterMovesWhatIsInsideAndNothingElse) {
  const generate::Arrays before = generate::ball(4);
  generate::Arrays after = before;
  generate::jitter_inner(after, 0.3, 5);
  std::size_t n_moved = 0;
  for (std::size_t v = 0; v < before.points.size(); ++v) {
    const bool on_sphere = norm(before.points[v]) > 1 - 1e-12;
    EXPECT_EQ(after.points[v] == before.points[v], on_sphere);
    EXPECT_LT(norm(after.points[v] - before.points[v]), 0.3 * std::sqrt(3.0) * 0.4);
    n_moved += on_sphere ? 0 : 1;
  }
  EXPECT_GT(n_moved, 100U);
  EXPECT_THROW(generate::jitter_inner(after, NAN, 5), InvalidInput);
}

TEST(Generate, BallIsRoundAndItsCellsAreGood) {
  for (const Index n : {1U, 2U, 3U, 8U}) {
    const Arrays mesh = ball(n, 2);
    EXPECT_EQ(mesh.cells.size(), 20U * n * n * n);
    EXPECT_EQ(n_not_positive(mesh), 0U);
    EXPECT_EQ(n_boundary_faces(mesh), 20U * n * n);
    expect_conforming(mesh);
    std::size_t on_sphere = 0;
    for (const Vec3& p : mesh.points) {
      EXPECT_LE(norm(p), 2 * (1 + 1e-15));
      on_sphere += std::abs(norm(p) - 2) < 1e-14 ? 1 : 0;
    }
    EXPECT_EQ(on_sphere, 10U * n * n + 2);
    EXPECT_GT(dihedral_range(mesh).first, 25);
    EXPECT_LT(dihedral_range(mesh).second, 135);
  }
  EXPECT_NEAR(total_volume(ball(16)), 4.0 / 3 * std::numbers::pi, 0.03);
  EXPECT_THROW(ball(0), InvalidInput);
  EXPECT_THROW(ball(2, -1), InvalidInput);
}

TEST(Generate, CylinderKeepsItsSurfaceUnderTwist) {
  for (const double twist : {0.0, 30.0, -90.0}) {
    const Arrays mesh = cylinder(3, 5, 0.5, 2, twist);
    EXPECT_EQ(mesh.cells.size(), 18U * 9 * 5);
    EXPECT_EQ(n_not_positive(mesh), 0U);
    EXPECT_EQ(n_boundary_faces(mesh), 2U * 54 + 2 * 18 * 5);
    expect_conforming(mesh);
    for (const Vec3& p : mesh.points) EXPECT_LE(std::hypot(p.x, p.y), 0.5 * (1 + 1e-15));
  }
  const Arrays straight = cylinder(12, 24);
  EXPECT_NEAR(total_volume(straight), 2 * std::numbers::pi, 0.02);
  EXPECT_GT(dihedral_range(straight).first, 15);
  EXPECT_THROW(cylinder(0, 1), InvalidInput);
  EXPECT_THROW(cylinder(1, 1, 1, 0), InvalidInput);
}

TEST(Generate, FandiskHasItsPlanesCylindersAndCorners) {
  for (const double jitter : {0.0, 0.2}) {
    const Arrays mesh = fandisk({3, 4, 2}, jitter, 3);
    EXPECT_EQ(mesh.cells.size(), 6U * 3 * 4 * 2 * 3);
    EXPECT_EQ(n_not_positive(mesh), 0U);
    EXPECT_EQ(n_boundary_faces(mesh), 2U * (3 * 8 * 2 + 2 * (8 * 2 + 4 * 2) + 3 * (2 + 4 + 2)));
    expect_conforming(mesh);
    const double half = std::sqrt(0.5);
    std::size_t n_step = 0, n_high = 0, n_outer = 0;
    for (const Vec3& p : mesh.points) {
      EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.z >= 0 && std::hypot(p.x, p.y) <= 2 * (1 + 1e-15));
      EXPECT_LE(p.z, p.x >= p.y ? 1.3 - 0.15 * p.x : 0.5);
      n_step += p.x == p.y && p.z >= 0.5;
      n_high += p.z == 1.3 - 0.15 * p.x;
      n_outer += std::abs(std::hypot(p.x, p.y) - 2) < 1e-15;
    }
    EXPECT_EQ(n_step, 4U * 3);
    EXPECT_EQ(n_high, 4U * 5);
    EXPECT_EQ(n_outer, 9U * 3 + 5U * 2);
    for (const Vec3 corner : {Vec3{1, 0, 0}, Vec3{2, 0, 1}, Vec3{0, 2, 0.5}})
      EXPECT_EQ(std::count(mesh.points.begin(), mesh.points.end(), corner), 1);
    const auto on_step = [&](const Vec3& p) { return p.z == 0.5 && std::abs(p.x - half) < 1e-15; };
    EXPECT_EQ(std::count_if(mesh.points.begin(), mesh.points.end(), on_step), 1);
  }
  // Two quarters of a ring of area 3π/4 in all; the high one ends at 1.3 - 0.15x.
  const double low = 0.5 * 3 * std::numbers::pi / 8;
  const double high = 1.3 * 3 * std::numbers::pi / 8 - 0.15 * 7.0 / 3 * std::sqrt(0.5);
  EXPECT_NEAR(total_volume(fandisk({4, 24, 2})), low + high, 2e-3);
  EXPECT_THROW(fandisk({2, 0, 2}), InvalidInput);
  EXPECT_THROW(fandisk({2, 2, 2}, NAN), InvalidInput);
}

TEST(Generate, RandomNumbersAreThoseOfSplitmix64) {
  EXPECT_EQ(random_unit(0, 0), static_cast<double>(0xe220a8397b1dcdafULL >> 11) * 0x1p-53);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    EXPECT_GE(random_unit(2013, i), 0);
    EXPECT_LT(random_unit(2013, i), 1);
  }
}

}  // namespace
}  // namespace hfr::generate
