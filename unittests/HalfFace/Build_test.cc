// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "HalfFace/Check.hh"
#include "Meshes.hh"
#include "Oracle.hh"

namespace hfr {
namespace {

using test::Corners;

double six_volume(const TetMesh& mesh, CellHandle c) {
  const auto& v = mesh.cell(c).v;
  const Vec3 o = mesh.point(v[0]);
  return dot(mesh.point(v[1]) - o, cross(mesh.point(v[2]) - o, mesh.point(v[3]) - o));
}

std::size_t n_negative(const TetMesh& mesh) {
  std::size_t n = 0;
  for (CellHandle c : mesh.cells()) n += six_volume(mesh, c) < 0 ? 1 : 0;
  return n;
}

std::string message_of(auto&& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(Build, MatesAreThoseOfTheOracle) {
  for (const auto& [name, mesh] : test::suite()) {
    const test::Oracle oracle(mesh);
    for (HalfFaceHandle h : mesh.halffaces()) {
      const auto& cells = oracle.faces().at(AnyOrder::key(mesh.halfface_vertices(h)));
      ASSERT_EQ(mesh.opposite_halfface(h).is_valid(), cells.size() == 2) << name;
    }
    EXPECT_EQ(check(mesh, {.last = Rule::kDuplicateEdge}), Ok) << name;
  }
}

TEST(Build, HandlesAndCornersAreThoseOfTheArrays) {
  const generate::Arrays box = generate::box({2, 3, 2});
  BuildReport report;
  const TetMesh mesh = build(box.points, box.cells, {}, &report);
  EXPECT_FALSE(report.flipped);
  EXPECT_TRUE(report.reoriented.empty());
  for (std::size_t i = 0; i < box.cells.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(mesh.cell(CellHandle(i)).v[k].idx(), box.cells[i][k]);
  for (VertexHandle v : mesh.vertices())
    for (CellHandle c : mesh.vertex_cells(v))
      EXPECT_LE(mesh.incident_cell(v), c) << "the incident_cell is the smallest cell";
}

TEST(Build, SameForAnyNumberOfThreads) {
  const generate::Arrays box = generate::jittered_box({9, 8, 7}, 0.3, 1);
  const TetMesh serial = test::built(box);
  for (int threads : {2, 3, 7, 16}) {
    const TetMesh mesh = build(box.points, box.cells, {.threads = threads, .serial_below = 1});
    for (CellHandle c : mesh.cells()) {
      ASSERT_EQ(mesh.cell(c).v, serial.cell(c).v);
      ASSERT_EQ(mesh.cell(c).mate, serial.cell(c).mate);
    }
    for (VertexHandle v : mesh.vertices()) ASSERT_EQ(mesh.incident_cell(v), serial.incident_cell(v));
  }
}

TEST(Build, RandomOrderGivesTheSameNeighbours) {
  generate::Arrays box = generate::box({5, 5, 5});
  const std::size_t n_faces = test::built(box).n_faces();
  for (std::size_t i = box.cells.size(); i > 1; --i)
    std::swap(box.cells[i - 1],
              box.cells[static_cast<std::size_t>(generate::random_unit(4, i) * static_cast<double>(i))]);
  const TetMesh mesh = test::built(box);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_EQ(mesh.n_faces(), n_faces);
}

TEST(Build, VertexOfVeryManyCells) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<Corners> cells;
  constexpr Index kCells = 5000;
  for (Index i = 0; i < kCells; ++i) {
    const double angle = 6.283185307179586 * i / kCells;
    points.push_back({std::cos(angle), std::sin(angle), 0});
    cells.push_back({0, 1, 2 + i, 2 + (i + 1) % kCells});
  }
  EXPECT_EQ(check(build(points, cells)), Ok);
}

TEST(Orientation, MeshGivenTheOtherWayRoundIsFlippedAsAWhole) {
  generate::Arrays box = generate::box({2, 2, 2});
  for (Corners& c : box.cells) std::swap(c[0], c[1]);
  BuildReport report;
  const TetMesh mesh = build(box.points, box.cells, {}, &report);
  EXPECT_TRUE(report.flipped);
  EXPECT_TRUE(report.reoriented.empty());
  EXPECT_EQ(n_negative(mesh), 0U);
  EXPECT_EQ(check(mesh), Ok);
}

TEST(Orientation, InvertedCellsStayInverted) {
  const generate::Arrays cavity = generate::jittered_box({6, 6, 6}, 0.45, 3);
  BuildReport report;
  const TetMesh mesh = build(cavity.points, cavity.cells, {}, &report);
  EXPECT_FALSE(report.flipped);
  EXPECT_TRUE(report.reoriented.empty());
  EXPECT_GT(n_negative(mesh), 0U);
  EXPECT_EQ(check(mesh), Ok);
}

TEST(Orientation, CellThatContradictsItsNeighboursIsTurned) {
  generate::Arrays box = generate::box({2, 2, 2});
  std::swap(box.cells[5][1], box.cells[5][2]);
  std::swap(box.cells[20][0], box.cells[20][3]);
  BuildReport report;
  const TetMesh mesh = build(box.points, box.cells, {}, &report);
  EXPECT_EQ(report.reoriented, (std::vector{CellHandle(5), CellHandle(20)}));
  EXPECT_FALSE(report.flipped);
  EXPECT_EQ(n_negative(mesh), 0U);
  EXPECT_EQ(check(mesh), Ok);
}

TEST(Orientation, CellOfNegativeVolumeRenumberedInTheFileIsInvertedAgain) {
  // What other programs do to an inverted cell: exchange two vertices, so that its volume is positive and its
  // faces contradict its neighbours'.
  generate::Arrays cavity = generate::jittered_box({6, 6, 6}, 0.45, 3);
  const TetMesh honest = test::built(cavity);
  std::vector<CellHandle> inverted;
  for (CellHandle c : honest.cells())
    if (six_volume(honest, c) < 0) inverted.push_back(c);
  ASSERT_GT(inverted.size(), 3U);
  for (CellHandle c : inverted) std::swap(cavity.cells[c.idx()][2], cavity.cells[c.idx()][3]);
  BuildReport report;
  const TetMesh mesh = build(cavity.points, cavity.cells, {}, &report);
  EXPECT_EQ(report.reoriented, inverted);
  EXPECT_EQ(n_negative(mesh), inverted.size());
  EXPECT_EQ(check(mesh), Ok);
}

/// Two boxes side by side that share nothing.
generate::Arrays two_boxes() {
  generate::Arrays both = generate::box({2, 2, 2});
  const generate::Arrays other = generate::box({2, 2, 2}, {5, 0, 0}, {6, 1, 1});
  const auto shift = static_cast<Index>(both.points.size());
  both.points.insert(both.points.end(), other.points.begin(), other.points.end());
  for (Corners c : other.cells) {
    for (Index& v : c) v += shift;
    both.cells.push_back(c);
  }
  return both;
}

TEST(Orientation, ComponentsGivenInDifferentOrdersAreEachMadePositive) {
  generate::Arrays both = two_boxes();
  for (std::size_t i = 48; i < 96; ++i) std::swap(both.cells[i][0], both.cells[i][1]);
  BuildReport report;
  const TetMesh mesh = build(both.points, both.cells, {}, &report);
  EXPECT_EQ(n_negative(mesh), 0U);
  EXPECT_FALSE(report.flipped);
  ASSERT_EQ(report.reoriented.size(), 48U);
  EXPECT_EQ(report.reoriented.front(), CellHandle(48));
  EXPECT_EQ(check(mesh), Ok);
}

TEST(Orientation, ComponentsAllTheOtherWayRoundAreAFlip) {
  generate::Arrays both = two_boxes();
  for (Corners& c : both.cells) std::swap(c[0], c[1]);
  BuildReport report;
  EXPECT_EQ(n_negative(build(both.points, both.cells, {}, &report)), 0U);
  EXPECT_TRUE(report.flipped);
  EXPECT_TRUE(report.reoriented.empty());
}

TEST(Orientation, LoneNegativeCellIsMadePositive) {
  // It contradicts nobody, so nothing tells an inverted cell from one that was written the other way round.
  generate::Arrays box = generate::box({2, 2, 2});
  const auto n = static_cast<Index>(box.points.size());
  box.points.insert(box.points.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});
  box.cells.push_back({n, n + 1, n + 3, n + 2});
  BuildReport report;
  const TetMesh mesh = build(box.points, box.cells, {}, &report);
  EXPECT_EQ(report.reoriented, std::vector{CellHandle(48)});
  EXPECT_EQ(n_negative(mesh), 0U);
}

TEST(Orientation, MoebiusBandOfCellsIsRefused) {
  // Triangular prisms in a ring of three, the last joined to the first with its triangle mirrored: cells see
  // each other across one face in the same order whichever way they are turned.
  std::vector<Vec3> points;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      points.push_back({static_cast<double>(i), static_cast<double>(k), 0.1 * i * k});
  std::vector<Corners> cells;
  const auto prism = [&](std::array<Index, 3> a, std::array<Index, 3> b) {
    cells.push_back({a[0], a[1], a[2], b[0]});
    cells.push_back({a[1], a[2], b[0], b[1]});
    cells.push_back({a[2], b[0], b[1], b[2]});
  };
  prism({0, 1, 2}, {3, 4, 5});
  prism({3, 4, 5}, {6, 7, 8});
  prism({6, 7, 8}, {1, 0, 2});
  EXPECT_THAT(message_of([&] { build(points, cells); }), testing::HasSubstr("cannot be oriented"));
}

TEST(BuildRefuses, FaceOfThreeCellsAndNamesThem) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 0, 2}};
  const std::vector<Corners> cells = {{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 1, 2, 5}};
  const std::string message = message_of([&] { build(points, cells); });
  EXPECT_THAT(message, testing::HasSubstr("0 1 2"));
  EXPECT_THAT(message, testing::HasSubstr("more than two cells: 0 1 2"));
}

TEST(BuildRefuses, IndexOutOfRange) {
  const std::vector<Vec3> points(4);
  EXPECT_THAT(message_of([&] {
                build(points, std::vector<Corners>{{0, 1, 2, 4}});
              }),
              testing::HasSubstr("cell 0: vertex index 4 is out of range; there are 4 vertices"));
}

TEST(BuildRefuses, CoordinatesThatAreNotFinite) {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    points[2].y = bad;
    EXPECT_THAT(message_of([&] {
                  build(points, std::vector<Corners>{{0, 1, 2, 3}});
                }),
                testing::HasSubstr("vertex 2"));
  }
}

TEST(BuildRefuses, VertexTwiceInACell) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Corners& c : {Corners{0, 0, 1, 2}, Corners{0, 1, 0, 2}, Corners{0, 1, 2, 0}, Corners{0, 1, 1, 2},
                           Corners{0, 1, 2, 1}, Corners{0, 1, 2, 2}})
    EXPECT_THAT(message_of([&] {
                  build(points, std::vector<Corners>{{0, 1, 2, 3}, c});
                }),
                testing::HasSubstr("cell 1: a vertex appears twice"));
}

TEST(BuildRefuses, CellTwice) {
  // The same cell in the same order cannot be told from two cells glued by all faces; it is one too many
  // anyhow.
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_THAT(message_of([&] {
                build(points, std::vector<Corners>{{0, 1, 2, 3}, {0, 1, 2, 3}});
              }),
              testing::HasSubstr("same four vertices"));
  EXPECT_THAT(message_of([&] {
                build(points, std::vector<Corners>{{0, 1, 2, 3}, {1, 0, 2, 3}});
              }),
              testing::HasSubstr("same four vertices"));
}

/// Rings of three cells each round the edge (0, 1), on vertices of their own; the last without its third cell
/// if `open`.
generate::Arrays rings_on_one_edge(int n, bool open) {
  generate::Arrays mesh;
  mesh.points = {{0, 0, -1}, {0, 0, 1}};
  for (int r = 0; r < n; ++r) {
    const auto first = static_cast<Index>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), {{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}});
    for (Index i = 0; i < 3; ++i) mesh.cells.push_back({0, 1, first + i, first + (i + 1) % 3});
  }
  if (open) mesh.cells.pop_back();
  return mesh;
}

TEST(BuildRefuses, EdgeThatCellsGoRoundTwice) {
  for (const bool open : {false, true}) {
    const generate::Arrays mesh = rings_on_one_edge(2, open);
    for (const int threads : {1, 3})
      EXPECT_THAT(message_of([&] {
                    build(mesh.points, mesh.cells, {threads, 1});
                  }),
                  testing::AllOf(testing::HasSubstr("the edge of vertices 0 and 1 exists twice"),
                                 testing::HasSubstr("cell 0"), testing::HasSubstr("cell 3"),
                                 testing::HasSubstr("--split-nonmanifold")));
  }
}

TEST(BuildSplits, EdgeThatCellsGoRoundTwice) {
  const generate::Arrays mesh = rings_on_one_edge(3, true);
  BuildReport report;
  const TetMesh split = build(mesh.points, mesh.cells, {}, &report, NonManifold::kSplit);
  EXPECT_EQ(check(split), Ok);
  EXPECT_EQ(report.copied, (std::vector{VertexHandle(0), VertexHandle(1), VertexHandle(0), VertexHandle(1)}));
  EXPECT_EQ(split.n_vertices(), mesh.points.size() + 4);
  for (std::size_t c = 0; c < split.n_cells(); ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t v = split.cell(CellHandle(c)).v[k].idx();
      const std::size_t given = v < mesh.points.size() ? v : report.copied[v - mesh.points.size()].idx();
      EXPECT_EQ(given, mesh.cells[c][k]);
      EXPECT_EQ(split.point(VertexHandle(v)), mesh.points[given]);
    }
}

TEST(BuildSplits, CellsThatTouchInAVertexOrAnEdgeAndNothingElse) {
  generate::Arrays box = generate::box({3, 3, 3});
  BuildReport report;
  build(box.points, box.cells, {}, &report, NonManifold::kSplit);
  EXPECT_TRUE(report.copied.empty());
  const auto n = static_cast<Index>(box.points.size());
  box.points.insert(box.points.end(), {{-1, -1, 0}, {-1, 0, -1}, {0, -1, -1}, {2, 2, 2}, {2, 2, 3}});
  box.cells.push_back({0, n, n + 1, n + 2});                // at a corner
  box.cells.push_back({box.cells[0][0], 1, n + 3, n + 4});  // along an edge of the box
  ASSERT_NE(check(build(box.points, box.cells)), Ok);
  const TetMesh split = build(box.points, box.cells, {}, &report, NonManifold::kSplit);
  EXPECT_EQ(check(split), Ok);
  EXPECT_GE(report.copied.size(), 2U);
}

TEST(BuildRefuses, EdgeOfWhichBothEndsConnectRoundIt) {
  // An icosahedron's cells of which two were given other corners: the cells of vertices 0 and 4 connect.
  std::vector<Vec3> points(13);
  for (std::size_t i = 0; i < 13; ++i) {
    const double x = static_cast<double>(i);
    points[i] = {x, x * x, x * x * x};
  }
  const std::vector<std::array<Index, 4>> cells = {
      {0, 1, 2, 3},  {0, 1, 3, 4},  {0, 1, 4, 5},   {0, 1, 5, 6},    {0, 1, 6, 2},
      {0, 4, 3, 7},  {0, 3, 2, 8},  {0, 2, 6, 9},   {0, 6, 5, 10},   {0, 5, 4, 11},
      {0, 12, 7, 8}, {0, 12, 8, 9}, {0, 12, 9, 10}, {0, 12, 10, 11}, {0, 12, 11, 7},
      {0, 8, 7, 3},  {0, 9, 4, 2},  {0, 10, 9, 6},  {0, 11, 10, 5},  {0, 7, 11, 4}};
  EXPECT_THAT(message_of([&] { build(points, cells); }),
              testing::HasSubstr("the edge of vertices 0 and 4 exists twice, once with cell 1"));
}

TEST(Build, EmptyMeshAndMeshWithoutCells) {
  EXPECT_EQ(build({}, {}).n_cells(), 0U);
  const TetMesh mesh = build({{0, 0, 0}, {1, 1, 1}}, {});
  EXPECT_EQ(mesh.n_vertices(), 2U);
  EXPECT_FALSE(mesh.incident_cell(VertexHandle(1)).is_valid());
  EXPECT_EQ(check(mesh), Ok);
}

TEST(Build, SingleCell) {
  const TetMesh mesh = test::single_cell();
  EXPECT_EQ(mesh.n_edges(), 6U);
  EXPECT_EQ(mesh.n_faces(), 4U);
  EXPECT_EQ(mesh.cell_cells(CellHandle(0)).size(), 0U);
  EXPECT_EQ(check(mesh), Ok);
}

}  // namespace
}  // namespace hfr
