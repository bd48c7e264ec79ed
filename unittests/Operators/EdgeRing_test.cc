// SPDX-License-Identifier: BSD-3-Clause
#include "Operators/EdgeRing.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "HalfFace/Meshes.hh"

namespace hfr {
namespace {

using C = CellHandle;
using V = VertexHandle;
using test::Corners;

/// n cells round the edge (0, 1), all the way or leaving out a sector.
TetMesh cells_round_an_edge(Index n, bool closed) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  const Index n_points = closed ? n : n + 1;
  for (Index i = 0; i < n_points; ++i) {
    const double angle = (closed ? 2.0 : 1.9) * std::numbers::pi * i / n;
    points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  std::vector<Corners> cells;
  for (Index i = 0; i < n; ++i) cells.push_back({0, 1, 2 + i, 2 + (i + 1) % n_points});
  return build(points, cells);
}

EdgeHandle edge_between(const TetMesh& mesh, C c, V a, V b) {
  for (Index e = 0; e < 6; ++e) {
    const auto ends = mesh.edge_vertices(EdgeHandle(6 * c.idx() + e));
    if ((ends[0] == a && ends[1] == b) || (ends[0] == b && ends[1] == a)) return EdgeHandle(6 * c.idx() + e);
  }
  return {};
}

/// Every cell stands between its two vertices, counter-clockwise about a→b.
void expect_in_order(const TetMesh& mesh, const EdgeFan& fan, V a, V b, bool closed) {
  const auto n = static_cast<std::size_t>(fan.n_cells);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<V, 4> named = {a, b, fan.vertices[i], fan.vertices[closed ? (i + 1) % n : i + 1]};
    auto own = mesh.cell(fan.cells[i]).v;
    int swaps = 0;  // that bring the cell's own order to the named one
    for (std::size_t k = 0; k < 4; ++k) {
      const auto at = std::find(own.begin(), own.end(), named[k]);
      ASSERT_NE(at, own.end());
      if (at == own.begin() + static_cast<std::ptrdiff_t>(k)) continue;
      std::swap(*at, own[k]);
      ++swaps;
    }
    EXPECT_EQ(swaps % 2, 0);
  }
}

TEST(ClosedRing, HasTheCellsRoundEveryInnerEdgeAndNoOther) {
  std::size_t n_inner = 0, n_boundary = 0;
  for (const auto& [name, mesh] : test::suite()) {
    for (EdgeHandle e : mesh.edges()) {
      EdgeRing ring;
      const bool found = gather_closed_ring(mesh, e, ring);
      ASSERT_EQ(found, !mesh.is_boundary(e)) << name;
      ++(found ? n_inner : n_boundary);
      if (!found) continue;
      EXPECT_EQ((std::array<V, 2>{ring.a, ring.b}), mesh.edge_vertices(e));
      const auto cells = mesh.edge_cells(e);
      ASSERT_EQ(static_cast<std::size_t>(ring.n_cells), cells.count());
      EXPECT_TRUE(std::equal(ring.begin(), ring.end(), cells.begin()));
      expect_in_order(mesh, ring, ring.a, ring.b, true);
    }
  }
  EXPECT_GT(n_inner, 100U);
  EXPECT_GT(n_boundary, 100U);
}

TEST(ClosedRing, HoldsAsManyCellsAsThePolygonHasRoomFor) {
  EdgeRing ring;
  for (const Index n : {3U, 32U}) {
    const TetMesh mesh = cells_round_an_edge(n, true);
    ASSERT_TRUE(gather_closed_ring(mesh, edge_between(mesh, C(0), V(0), V(1)), ring));
    EXPECT_EQ(ring.n_cells, static_cast<int>(n));
  }
  const TetMesh mesh = cells_round_an_edge(HFR_MAX_RING + 1, true);
  EXPECT_FALSE(gather_closed_ring(mesh, edge_between(mesh, C(0), V(0), V(1)), ring));
}

TEST(ClosedFan, BeginsWhereItIsToldTo) {
  const TetMesh mesh = cells_round_an_edge(7, true);
  for (Index c = 0; c < 7; ++c) {
    const RingPlace start = ring_start(edge_between(mesh, C(c), V(0), V(1)));
    EdgeFan one_way, other_way;
    ASSERT_TRUE(gather_closed_fan(mesh, start, one_way));
    ASSERT_TRUE(gather_closed_fan(mesh, {start.cell, start.q, start.p}, other_way));
    EXPECT_EQ(one_way.cells[0], C(c));
    EXPECT_EQ(other_way.cells[0], C(c));
    EXPECT_TRUE(std::equal(one_way.begin() + 1, one_way.end(),
                           std::make_reverse_iterator(other_way.begin() + other_way.n_cells)));
  }
}

TEST(OpenRing, GoesFromBoundaryToBoundaryAtEveryBoundaryEdgeAndNoOther) {
  std::size_t n_open = 0;
  for (const auto& [name, mesh] : test::suite()) {
    for (EdgeHandle e : mesh.edges()) {
      EdgeRing ring;
      const bool found = gather_open_ring(mesh, e, ring);
      ASSERT_EQ(found, mesh.is_boundary(e)) << name;
      if (!found) continue;
      ++n_open;
      const auto cells = mesh.edge_cells(e);
      ASSERT_EQ(static_cast<std::size_t>(ring.n_cells), cells.count());
      EXPECT_TRUE(std::equal(ring.begin(), ring.end(), cells.begin()));
      expect_in_order(mesh, ring, ring.a, ring.b, false);
      const auto n = static_cast<std::size_t>(ring.n_cells);
      const Cell& last = mesh.cell(ring.cells[n - 1]);
      EXPECT_FALSE(mesh.cell(ring.cells[0])
                       .mate[static_cast<std::size_t>(mesh.cell(ring.cells[0]).corner(ring.vertices[1]))]
                       .is_valid());
      EXPECT_FALSE(last.mate[static_cast<std::size_t>(last.corner(ring.vertices[n - 1]))].is_valid());
    }
  }
  EXPECT_GT(n_open, 100U);
}

TEST(OpenRing, HoldsOneCellLessThanThePolygonHasVertices) {
  EdgeRing ring;
  for (const Index n : {1U, 31U}) {
    const TetMesh mesh = cells_round_an_edge(n, false);
    ASSERT_TRUE(gather_open_ring(mesh, edge_between(mesh, C(0), V(0), V(1)), ring));
    EXPECT_EQ(ring.n_cells, static_cast<int>(n));
  }
  const TetMesh mesh = cells_round_an_edge(HFR_MAX_RING, false);
  EXPECT_FALSE(gather_open_ring(mesh, edge_between(mesh, C(0), V(0), V(1)), ring));
}

TEST(TwoSidedRing, HasARowForEachRegionWithCommonEnds) {
  TetMesh mesh = cells_round_an_edge(9, true);
  for (Index first = 0; first < 9; ++first) {
    for (Index n = 1; n < 9; ++n) {
      for (Index i = 0; i < 9; ++i) mesh.set_region(C((first + i) % 9), i < n ? 4 : 7);
      TwoSidedRing two;
      ASSERT_TRUE(gather_two_sided_ring(mesh, edge_between(mesh, C(3), V(0), V(1)), two));
      ASSERT_EQ(two.sides[0].n_cells, static_cast<int>(n));
      ASSERT_EQ(two.sides[1].n_cells, static_cast<int>(9 - n));
      for (C c : two.sides[0]) EXPECT_EQ(mesh.region(c), 4);
      for (C c : two.sides[1]) EXPECT_EQ(mesh.region(c), 7);
      for (const EdgeFan& side : two.sides) expect_in_order(mesh, side, two.a, two.b, false);
      EXPECT_EQ(two.sides[0].vertices[n], two.sides[1].vertices[0]);
      EXPECT_EQ(two.sides[1].vertices[9 - n], two.sides[0].vertices[0]);
    }
  }
}

TEST(TwoSidedRing, IsNoneOfOneRegionNorOfThreeNorOfOneThatComesTwice) {
  const auto found = [](const std::vector<int>& regions, bool closed) {
    TetMesh mesh = cells_round_an_edge(static_cast<Index>(regions.size()), closed);
    for (std::size_t i = 0; i < regions.size(); ++i) mesh.set_region(C(i), regions[i]);
    TwoSidedRing two;
    return gather_two_sided_ring(mesh, edge_between(mesh, C(0), V(0), V(1)), two);
  };
  EXPECT_TRUE(found({1, 1, 1, 2, 2, 2}, true));
  EXPECT_FALSE(found({1, 1, 1, 2, 2, 2}, false)) << "meets the boundary";
  EXPECT_FALSE(found({1, 1, 1, 1, 1, 1}, true));
  EXPECT_FALSE(found({1, 1, 2, 2, 3, 3}, true));
  EXPECT_FALSE(found({1, 2, 2, 1, 2, 2}, true));
}

TEST(TwoSidedRing, HoldsOneCellLessOnASideThanThePolygonHasVertices) {
  for (const Index n : {31U, 32U}) {
    TetMesh mesh = cells_round_an_edge(n + 3, true);
    for (Index i = 0; i < n + 3; ++i) mesh.set_region(C(i), i < n ? 2 : 1);
    TwoSidedRing two;
    EXPECT_EQ(gather_two_sided_ring(mesh, edge_between(mesh, C(0), V(0), V(1)), two), n < HFR_MAX_RING);
  }
}

}  // namespace
}  // namespace hfr
