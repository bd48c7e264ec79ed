// SPDX-License-Identifier: BSD-3-Clause
#include "Quality/Statistics.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "HalfFace/Generate.hh"
#include "HalfFace/TetMesh.hh"
#include "HalfFace/Writer.hh"
#include "Quality/FixedSum.hh"
#include "Quality/Metrics.hh"
#include "Quality/Tets.hh"

namespace hfr {
namespace {

using testing::ElementsAre;

TetMesh mesh_of(const generate::Arrays& arrays) {
  TetMesh mesh = build(arrays.points, arrays.cells);
  for (std::size_t i = 0; i < arrays.regions.size(); ++i) mesh.set_region(CellHandle(i), arrays.regions[i]);
  return mesh;
}

TetMesh mesh_of_one(const test::Tet& t) {
  const std::array<std::array<Index, 4>, 1> cells = {{{0, 1, 2, 3}}};
  return build({t[0], t[1], t[2], t[3]}, cells);
}

std::uint64_t total(const auto& histogram) {
  return std::accumulate(histogram.begin(), histogram.end(), std::uint64_t{0});
}

void expect_equal(const Distribution& a, const Distribution& b) {
  EXPECT_EQ(a.percentiles, b.percentiles);
  EXPECT_EQ(a.min, b.min);
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.max, b.max);
}

void expect_equal(const EdgeWedge& a, const EdgeWedge& b) {
  EXPECT_EQ(a.degrees, b.degrees);
  EXPECT_EQ(a.a, b.a);
  EXPECT_EQ(a.b, b.b);
  EXPECT_EQ(a.cell, b.cell);
}

void expect_equal(const Statistics& a, const Statistics& b) {
  EXPECT_EQ(std::tie(a.vertices, a.unused_vertices, a.cells, a.edges, a.faces, a.boundary_faces),
            std::tie(b.vertices, b.unused_vertices, b.cells, b.edges, b.faces, b.boundary_faces));
  EXPECT_EQ(std::tie(a.interface_faces, a.components, a.inverted, a.flat, a.worst_cell),
            std::tie(b.interface_faces, b.components, b.inverted, b.flat, b.worst_cell));
  expect_equal(a.min_dihedral, b.min_dihedral);
  expect_equal(a.volume_length, b.volume_length);
  EXPECT_EQ(std::tie(a.mean_dihedral, a.max_dihedral, a.dihedral_histogram, a.volume_length_histogram),
            std::tie(b.mean_dihedral, b.max_dihedral, b.dihedral_histogram, b.volume_length_histogram));
  EXPECT_EQ(a.min_dihedral_histogram, b.min_dihedral_histogram);
  EXPECT_EQ(std::tie(a.min_edge, a.mean_edge, a.max_edge, a.box_low, a.box_high),
            std::tie(b.min_edge, b.mean_edge, b.max_edge, b.box_low, b.box_high));
  EXPECT_EQ(std::tie(a.volume, a.absolute_volume, a.enclosed_volume, a.overlap),
            std::tie(b.volume, b.absolute_volume, b.enclosed_volume, b.overlap));
  ASSERT_EQ(a.regions.size(), b.regions.size());
  for (std::size_t i = 0; i < a.regions.size(); ++i) {
    EXPECT_EQ(a.regions[i].volume, b.regions[i].volume);
    EXPECT_EQ(a.regions[i].min_dihedral, b.regions[i].min_dihedral);
  }
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t i = 0; i < a.patches.size(); ++i) EXPECT_EQ(a.patches[i].area, b.patches[i].area);
  expect_equal(a.surface_ceiling, b.surface_ceiling);
  expect_equal(a.interface_ceiling, b.interface_ceiling);
  expect_equal(a.angle_ceiling, b.angle_ceiling);
}

TEST(Statistics, CellsBelowADegreeAreThoseThatMissItAsAGoal) {
  const TetMesh mesh = mesh_of(generate::cavity());
  const Statistics s = statistics(mesh);
  ASSERT_FALSE(s.inverted.empty());
  EXPECT_EQ(n_cells_below(s, 0), s.inverted.size());
  EXPECT_EQ(n_cells_below(s, 71), s.cells);
  EXPECT_EQ(n_cells_below(s, 1000), s.cells);
  EXPECT_EQ(total(s.min_dihedral_histogram), s.cells - s.inverted.size());
  for (std::size_t degrees = 1; degrees < 71; ++degrees) {
    const double goal = dihedral_decision(static_cast<double>(degrees));
    std::size_t n = 0;
    for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
      const auto& v = mesh.cell_vertices(CellHandle(i));
      n += MinDihedral{}(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) < goal;
    }
    EXPECT_EQ(n_cells_below(s, degrees), n) << degrees;
  }
}

TEST(Statistics, AFlatCellIsBelowOneDegreeAndNotInverted) {
  const Statistics s = statistics(mesh_of_one({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}}));
  ASSERT_EQ(s.flat.size(), 1U);
  EXPECT_EQ(s.min_dihedral_histogram[0], 1U);
  EXPECT_EQ(n_cells_below(s, 0), 0U);
  EXPECT_EQ(n_cells_below(s, 1), 1U);
}

TEST(Statistics, KuhnCubeIsWhatOneCanCountByHand) {
  const Statistics s = statistics(mesh_of(generate::box({1, 1, 1})));
  EXPECT_EQ(s.vertices, 8U);
  EXPECT_EQ(s.unused_vertices, 0U);
  EXPECT_EQ(s.cells, 6U);
  EXPECT_EQ(s.boundary_faces, 12U);
  EXPECT_EQ(s.faces, 18U);
  EXPECT_EQ(s.edges, 19U);  // 12 of the cube, 6 face diagonals, 1 through the middle
  EXPECT_EQ(s.components, 1U);
  EXPECT_THAT(s.inverted, ElementsAre());
  EXPECT_THAT(s.flat, ElementsAre());
  EXPECT_DOUBLE_EQ(s.volume, 1.0);
  EXPECT_DOUBLE_EQ(s.absolute_volume, 1.0);
  EXPECT_DOUBLE_EQ(s.enclosed_volume, 1.0);
  EXPECT_NEAR(s.overlap, 0.0, 1e-15);
  // each Kuhn cell has angles 45, 45, 60, 90, 90, 90
  EXPECT_NEAR(s.min_dihedral.min, 45.0, 1e-12);
  EXPECT_NEAR(s.min_dihedral.mean, 45.0, 1e-10);
  EXPECT_NEAR(s.max_dihedral, 90.0, 1e-6);
  EXPECT_NEAR(s.mean_dihedral, 70.0, 1e-10);
  std::array<std::uint64_t, 36> histogram{};
  histogram[9] = 12;
  histogram[12] = 6;
  histogram[18] = 18;
  EXPECT_EQ(s.dihedral_histogram, histogram);
  const double q = 6 * std::sqrt(2.0) / 6 / std::pow(10.0 / 6, 1.5);
  EXPECT_NEAR(s.volume_length.min, q, 1e-14);
  EXPECT_NEAR(s.volume_length.mean, q, 1e-12);
  EXPECT_EQ(s.volume_length_histogram[static_cast<std::size_t>(20 * q)], 6U);
  EXPECT_DOUBLE_EQ(s.min_edge, 1.0);
  EXPECT_DOUBLE_EQ(s.max_edge, std::sqrt(3.0));
  EXPECT_NEAR(s.mean_edge, (3 + 2 * std::sqrt(2.0) + std::sqrt(3.0)) / 6, 1e-12);
  EXPECT_EQ(s.box_low, (Vec3{0, 0, 0}));
  EXPECT_EQ(s.box_high, (Vec3{1, 1, 1}));
  EXPECT_NEAR(s.surface_ceiling.degrees, 90.0, 1e-12);
  ASSERT_EQ(s.patches.size(), 1U);
  EXPECT_EQ(s.patches[0].label, 0);
  EXPECT_EQ(s.patches[0].faces, 12U);
  EXPECT_DOUBLE_EQ(s.patches[0].area, 6.0);
}

TEST(Statistics, EveryThreadCountGivesTheSameBits) {
  generate::CavityOptions options;
  options.counts = {9, 10, 11};
  options.jitter = 0.3;
  TetMesh mesh = mesh_of(generate::cavity(options));
  for (std::size_t i = 0; i < mesh.n_cells(); ++i)
    mesh.set_region(CellHandle(i), static_cast<int>(i / 1000) % 3);
  const Statistics serial = statistics(mesh, {.threads = 1, .serial_below = 1});
  EXPECT_GT(serial.inverted.size(), 10U) << "the generator no longer inverts cells";
  for (const int threads : {2, 3, 7}) {
    SCOPED_TRACE(threads);
    expect_equal(statistics(mesh, {.threads = threads, .serial_below = 1}), serial);
  }
}

TEST(Statistics, AgreesWithTheDefinitionsCellByCell) {
  const TetMesh mesh = mesh_of(generate::jittered_box({8, 8, 8}, 0.28, 5));
  const Statistics s = statistics(mesh);
  std::vector<double> least;
  std::array<std::uint64_t, 36> histogram{};
  double sum = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    const Cell& c = mesh.cell(CellHandle(i));
    const auto angles =
        dihedrals(mesh.point(c.v[0]), mesh.point(c.v[1]), mesh.point(c.v[2]), mesh.point(c.v[3]));
    const bool inverted = *std::min_element(angles.begin(), angles.end()) < 0;
    const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
    least.push_back(*std::min_element(angles.begin(), angles.end(), smaller));
    for (const double angle : angles) {
      sum += angle;
      if (!inverted) ++histogram[static_cast<std::size_t>(angle / 5)];
      if (!inverted) largest = std::max(largest, angle);
    }
  }
  ASSERT_GT(s.inverted.size(), 0U);
  EXPECT_EQ(total(s.dihedral_histogram), 6 * (s.cells - s.inverted.size()));
  EXPECT_EQ(total(s.volume_length_histogram), s.cells - s.inverted.size());
  EXPECT_EQ(s.dihedral_histogram, histogram);
  EXPECT_NEAR(s.mean_dihedral, sum / (6.0 * static_cast<double>(s.cells)), 1e-10);
  EXPECT_NEAR(s.max_dihedral, largest, 1e-6);
  std::sort(least.begin(), least.end());
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
    const double rank = std::ceil(kPercentiles[i] / 100 * static_cast<double>(least.size()));
    EXPECT_NEAR(s.min_dihedral.percentiles[i], least[static_cast<std::size_t>(rank) - 1], 1e-9);
  }
  EXPECT_NEAR(s.min_dihedral.min, least.front(), 1e-9);
  EXPECT_NEAR(s.min_dihedral.max, least.back(), 1e-9);
}

TEST(Statistics, InvertedCellsShowAsOverlapWhileTheSignedVolumeStays) {
  TetMesh mesh = mesh_of(generate::box({2, 2, 2}));
  mesh.set_point(VertexHandle(13), {1.3, 0.4, 0.5});  // the centre, pushed out through a side
  const Statistics s = statistics(mesh);
  EXPECT_GT(s.inverted.size(), 0U);
  EXPECT_TRUE(std::is_sorted(s.inverted.begin(), s.inverted.end()));
  EXPECT_NEAR(s.volume, 1.0, 1e-15);
  EXPECT_NEAR(s.enclosed_volume, 1.0, 1e-15);
  EXPECT_GT(s.overlap, 0.1);
  EXPECT_NEAR(s.overlap, s.absolute_volume - 1.0, 1e-14);
  EXPECT_LT(s.min_dihedral.min, 0.0);
  EXPECT_LT(s.volume_length.min, 0.0);
}

TEST(Statistics, FlatCellIsListedAndCountsAsZeroDegrees) {
  const std::array<std::array<Index, 4>, 1> cells = {{{0, 1, 2, 3}}};
  const TetMesh mesh = build({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, cells);
  const Statistics s = statistics(mesh);
  EXPECT_THAT(s.flat, ElementsAre(CellHandle(0)));
  EXPECT_THAT(s.inverted, ElementsAre());
  EXPECT_EQ(s.min_dihedral.min, 0.0);
  EXPECT_EQ(s.max_dihedral, 180.0);
  EXPECT_EQ(s.dihedral_histogram[0], 4U);
  EXPECT_EQ(s.dihedral_histogram[35], 2U);
  EXPECT_EQ(s.volume_length_histogram[0], 1U);
  EXPECT_EQ(s.overlap, 0.0);
}

TEST(Statistics, UnusedVerticesAndSeparatePartsAreCounted) {
  test::Tet t = test::regular_tet();
  std::vector<Vec3> points(t.begin(), t.end());
  for (const Vec3 p : t) points.push_back(p + Vec3{5, 0, 0});
  points.push_back({9, 9, 9});
  const std::array<std::array<Index, 4>, 2> cells = {{{0, 1, 2, 3}, {4, 5, 6, 7}}};
  const Statistics s = statistics(build(points, cells));
  EXPECT_EQ(s.vertices, 9U);
  EXPECT_EQ(s.unused_vertices, 1U);
  EXPECT_EQ(s.components, 2U);
  EXPECT_EQ(s.edges, 12U);
  EXPECT_EQ(s.faces, 8U);
  EXPECT_NEAR(s.surface_ceiling.degrees, std::acos(1.0 / 3.0) * 180 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(s.angle_ceiling.degrees, s.surface_ceiling.degrees, 1e-12) << "a single cell in each wedge";
  StatisticsOptions bare;
  bare.components = bare.surface = false;
  const Statistics less = statistics(build(points, cells), {}, bare);
  EXPECT_EQ(less.components, 0U);
  EXPECT_TRUE(less.patches.empty());
  EXPECT_FALSE(less.surface_ceiling.cell.is_valid());
}

/// Boxes apart from one another whose cells are mixed, so that each thread has some of all; one of them falls
/// into two where cells between its halves are deleted.
TEST(Statistics, SeparatePartsAreCountedByAnyThreads) {
  constexpr std::size_t kBoxes = 5;
  const TetMesh one = mesh_of(generate::box({4, 2, 2}));
  std::vector<Vec3> points;
  std::vector<std::array<Index, 4>> cells;
  for (std::size_t box = 0; box < kBoxes; ++box) {
    const auto first = static_cast<Index>(points.size());
    for (const Vec3 p : one.points()) points.push_back(p + Vec3{0, 9.0 * static_cast<double>(box), 0});
    for (const CellHandle c : one.cells()) {
      std::array<Index, 4> corners{};
      for (std::size_t k = 0; k < 4; ++k) corners[k] = one.cell(c).v[k].idx() + first;
      cells.push_back(corners);
    }
  }
  for (const bool is_mixed : {false, true}) {
    if (is_mixed)
      std::ranges::sort(cells, {}, [&](const auto& c) { return mix64(c[0] + 1000ULL * c[1] + c[2] * c[3]); });
    TetMesh mesh = build(points, cells);
    for (const int threads : {1, 2, 3, 8})
      EXPECT_EQ(statistics(mesh, {.threads = threads, .serial_below = 1}).components, kBoxes) << threads;
    double low = 1e9, high = -1e9;
    for (const Vec3 p : one.points()) low = std::min(low, p.x), high = std::max(high, p.x);
    const double quarter = low + (high - low) / 4, half = low + (high - low) / 2;
    for (const CellHandle c : mesh.cells()) {
      Vec3 middle;
      for (const VertexHandle v : mesh.cell(c).v) middle = middle + 0.25 * mesh.point(v);
      if (middle.y < 5 && middle.x > quarter && middle.x < half) mesh.delete_cell(c);
    }
    for (const int threads : {1, 2, 3, 8})
      EXPECT_EQ(statistics(mesh, {.threads = threads, .serial_below = 1}).components, kBoxes + 1) << threads;
  }
}

TEST(Statistics, DeletedCellsDoNotCount) {
  TetMesh mesh = mesh_of(generate::box({1, 1, 1}));
  const Statistics whole = statistics(mesh);
  const std::size_t n = mesh.n_cells();
  TetMesh::Writer(mesh).resize_cells(n + 2);  // two deleted cells
  TetMesh::Writer(mesh).free_cells() = {CellHandle(n), CellHandle(n + 1)};
  expect_equal(statistics(mesh), whole);
}

TEST(Statistics, MeshWithoutCellsGivesZeros) {
  const Statistics s = statistics(TetMesh{});
  EXPECT_EQ(s.cells, 0U);
  EXPECT_EQ(s.edges, 0U);
  EXPECT_EQ(s.min_dihedral.min, 0.0);
  EXPECT_EQ(s.mean_dihedral, 0.0);
  EXPECT_EQ(s.volume, 0.0);
  EXPECT_FALSE(s.worst_cell.is_valid());
}

TEST(Statistics, RegionsHaveTheirOwnVolumeAndTheInterfaceItsCeiling) {
  const TetMesh mesh = mesh_of(generate::two_region_box({2, 1, 1}));
  const Statistics s = statistics(mesh);
  ASSERT_EQ(s.regions.size(), 2U);
  EXPECT_EQ(s.regions[0].region, 1);
  EXPECT_EQ(s.regions[1].region, 2);
  for (const RegionStatistics& region : s.regions) {
    EXPECT_EQ(region.cells, 6U);
    EXPECT_DOUBLE_EQ(region.volume, 0.5);
    EXPECT_EQ(region.inverted, 0U);
  }
  EXPECT_EQ(s.interface_faces, 2U);
  // at the rim of the interface a flat side (180) is cut into two right angles
  EXPECT_NEAR(s.surface_ceiling.degrees, 90.0, 1e-12);
  EXPECT_NEAR(s.interface_ceiling.degrees, 90.0, 1e-12);
}

TEST(Statistics, SlantedInterfaceLowersTheCeilingOfItsWedge) {
  // two cells on one triangle, the lower one shallow: 90 degrees between the sides, less under the interface
  const double depth = 0.1;
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1}, {0.3, 0.3, -depth}};
  const std::array<std::array<Index, 4>, 2> cells = {{{0, 1, 2, 3}, {0, 2, 1, 4}}};
  TetMesh mesh = build(points, cells);
  const Statistics one = statistics(mesh);
  mesh.set_region(CellHandle(1), 7);
  const Statistics two = statistics(mesh);
  const double shallow = statistics(mesh).min_dihedral.min;
  EXPECT_EQ(two.surface_ceiling.degrees, one.surface_ceiling.degrees);
  EXPECT_EQ(one.interface_ceiling.degrees, one.surface_ceiling.degrees);
  EXPECT_GT(one.surface_ceiling.degrees, shallow + 1);
  EXPECT_NEAR(two.interface_ceiling.degrees, shallow, 1e-10);
  EXPECT_EQ(two.interface_ceiling.cell, CellHandle(1));
}

TEST(Statistics, CeilingOfTheSurfaceDoesNotDependOnTheInside) {
  TetMesh mesh = mesh_of(generate::cylinder(2, 3));
  const double before = statistics(mesh).surface_ceiling.degrees;
  std::vector<bool> on_boundary(mesh.n_vertices(), false);
  for (std::size_t i = 0; i < 4 * mesh.n_cells(); ++i)
    if (!mesh.opposite_halfface(HalfFaceHandle(i)).is_valid())
      for (const VertexHandle v : mesh.halfface_vertices(HalfFaceHandle(i))) on_boundary[v.idx()] = true;
  test::RandomTets random(4);
  int moved = 0;
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    if (on_boundary[i]) continue;
    mesh.set_point(VertexHandle(i), 3.0 * random.point());
    ++moved;
  }
  ASSERT_GT(moved, 0);
  const Statistics after = statistics(mesh);
  ASSERT_GT(after.inverted.size(), 0U);
  EXPECT_NEAR(after.surface_ceiling.degrees, before, 1e-9);
}

TEST(Statistics, PatchesListLabelledFacesWhereverTheyLie) {
  TetMesh mesh = mesh_of(generate::two_region_box({2, 1, 1}));
  int boundary = 0;
  for (std::size_t i = 0; i < 4 * mesh.n_cells(); ++i) {
    const HalfFaceHandle h(i);
    const HalfFaceHandle m = mesh.opposite_halfface(h);
    const auto face = mesh.halfface_vertices(h);
    if (m.is_valid() && mesh.region(cell_of(m)) != mesh.region(cell_of(h))) mesh.labels().faces.set(face, 30);
    if (m.is_valid() || boundary >= 5) continue;
    mesh.labels().faces.set(face, 10);
    ++boundary;
  }
  const Statistics s = statistics(mesh);
  ASSERT_EQ(s.patches.size(), 3U);
  EXPECT_EQ(s.patches[0].label, 0);
  EXPECT_EQ(s.patches[0].faces, s.boundary_faces - 5);
  EXPECT_EQ(s.patches[1].label, 10);
  EXPECT_EQ(s.patches[1].faces, 5U);
  EXPECT_EQ(s.patches[2].label, 30);
  EXPECT_EQ(s.patches[2].faces, 2U);
  EXPECT_DOUBLE_EQ(s.patches[2].area, 1.0);
  EXPECT_DOUBLE_EQ(s.patches[0].area + s.patches[1].area, 6.0);
}

TEST(Statistics, BallHasTheEulerNumbersOfABall) {
  const Statistics s = statistics(mesh_of(generate::ball(3)));
  EXPECT_EQ(s.cells, 540U);
  EXPECT_EQ(s.vertices + s.faces, s.edges + s.cells + 1);
  EXPECT_LT(s.enclosed_volume, 4.0 / 3 * std::numbers::pi);
  EXPECT_NEAR(s.overlap, 0.0, 1e-13);
}

TEST(Statistics, CoordinatesNearTheEndsOfTheRangeGiveNoNaN) {
  for (const double scale : {1e-90, 1e-40, 1e-20, 1e20, 1e40}) {
    test::Tet t = test::regular_tet();
    for (Vec3& p : t) p = scale * p;
    const Statistics s = statistics(mesh_of_one(t));
    EXPECT_FALSE(std::isnan(s.mean_dihedral)) << scale;
    EXPECT_FALSE(std::isnan(s.min_dihedral.mean)) << scale;
    EXPECT_FALSE(std::isnan(s.volume_length.mean)) << scale;
    EXPECT_TRUE(s.inverted.empty()) << scale;
    EXPECT_EQ(total(s.dihedral_histogram), 6U) << scale;
  }
}

TetMesh box_of(Index n) {
  const auto arrays = generate::jittered_box({n, n, n}, 0, 1);
  return build(arrays.points, arrays.cells);
}

/// A vertex without cells may be anywhere, and parts far from each other: neither is overlap.
TEST(Statistics, OverlapIsOfTheCellsAlone) {
  for (const double far : {1e4, 1e5, 1e8}) {
    TetMesh mesh = box_of(1);
    mesh.add_vertex({far, far, far});
    const Statistics s = statistics(mesh);
    EXPECT_NEAR(s.volume, 1, 1e-12) << far;
    EXPECT_NEAR(s.overlap, 0, 1e-12) << far;
    EXPECT_EQ(s.box_high.x, far) << "the box is that of all vertices";
  }
  for (const double far : {1e3, 1e5}) {
    std::vector<Vec3> points;
    std::vector<std::array<Index, 4>> cells;
    const TetMesh one = box_of(1);
    for (const double shift : {0.0, far}) {
      const auto first = static_cast<Index>(points.size());
      for (Vec3 p : one.points()) points.push_back(p + Vec3{shift, shift, shift});
      for (CellHandle c : one.cells()) {
        std::array<Index, 4> corners{};
        for (std::size_t k = 0; k < 4; ++k) corners[k] = one.cell(c).v[k].idx() + first;
        cells.push_back(corners);
      }
    }
    const Statistics s = statistics(build(points, cells));
    EXPECT_EQ(s.components, 2U);
    EXPECT_NEAR(s.overlap, 0, 1e-10) << far;
  }
}

TEST(Statistics, ACoordinateThatIsNoNumberGivesTheSameForAnyThreads) {
  TetMesh mesh = box_of(14);
  ASSERT_GT(mesh.n_vertices(), 2048U);
  mesh.set_point(VertexHandle(0), {std::numeric_limits<double>::quiet_NaN(), 0, 0});
  const Statistics one = statistics(mesh, {.threads = 1});
  for (const int threads : {2, 4}) {
    const Statistics more = statistics(mesh, {.threads = threads});
    EXPECT_EQ(more.box_low, one.box_low);
    EXPECT_EQ(more.box_high, one.box_high);
    EXPECT_EQ(std::isnan(more.volume), std::isnan(one.volume));
    EXPECT_EQ(more.mean_edge, one.mean_edge);
  }
  EXPECT_EQ(one.box_high.x, 1);
}

TEST(FixedSumTest, DoesNotDependOnTheOrder) {
  test::RandomTets random(8);
  std::vector<double> values;
  for (int i = 0; i < 300000; ++i) values.push_back(random.coordinate() - 0.5);
  FixedSum forward(1.0);
  for (const double x : values) forward.add(x);
  FixedSum backward(1.0);
  FixedSum tail(1.0);
  for (std::size_t i = 1000; i-- > 0;) tail.add(values[i]);
  for (std::size_t i = values.size(); i-- > 1000;) backward.add(values[i]);
  backward.add(tail);
  EXPECT_EQ(forward.value(), backward.value());
  long double expected = 0;
  for (const double x : values) expected += x;
  EXPECT_NEAR(forward.value(), static_cast<double>(expected), 1e-13);
}

TEST(FixedSumTest, KeepsWhatPlainAdditionLoses) {
  FixedSum sum(2.0);
  sum.add(1.0);
  for (int i = 0; i < 1000; ++i) sum.add(1e-17);
  sum.add(-1.0);
  EXPECT_NEAR(sum.value(), 1e-14, 1e-20);
}

TEST(FixedSumTest, NumberBeyondTheBoundMakesItNaN) {
  FixedSum sum(1.0);
  sum.add(4.0);
  EXPECT_TRUE(std::isnan(sum.value()));
  FixedSum other(1.0);
  other.add(std::nan(""));
  EXPECT_TRUE(std::isnan(other.value()));
}

}  // namespace
}  // namespace hfr
