// SPDX-License-Identifier: BSD-3-Clause
#include "HalfFace/Layers.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "Meshes.hh"

namespace hfr {
namespace {

using C = CellHandle;
using Flags = std::vector<std::uint8_t>;

/// Layer by layer over all vertices of the mesh.
Flags flags_by_sweeps(const TetMesh& mesh, const std::vector<C>& cells, int layers) {
  Flags flags(mesh.n_vertices(), 0);
  for (C c : cells)
    for (VertexHandle v : mesh.cell(c).v) flags[v.idx()] = 1;
  for (int layer = 0; layer < layers; ++layer) {
    const Flags before = flags;
    for (VertexHandle v : mesh.vertices()) {
      if (!before[v.idx()]) continue;
      for (C c : mesh.vertex_cells(v))
        for (VertexHandle w : mesh.cell(c).v) flags[w.idx()] = 1;
    }
  }
  return flags;
}

std::size_t n_set(const Flags& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
}

/// Cells round one edge, more than a Star holds, all of which have the vertices 0 and 1.
TetMesh many_round_an_edge(Index n) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<test::Corners> cells;
  for (Index i = 0; i < n; ++i) {
    points.push_back({std::cos(i * 0.02), std::sin(i * 0.02), 0});
    cells.push_back({0, 1, 2 + i, 2 + (i + 1) % n});
  }
  return build(points, cells);
}

TEST(GrowLayers, TakesEachItemOnceAndInOrderOfDiscovery) {
  // A path with a branch: 0 - 1 - 2 - 3, and 1 - 4.
  const std::vector<std::vector<int>> next = {{1}, {0, 2, 4}, {1, 3}, {2}, {1}};
  const auto within = [&](std::vector<int> items, int layers) {
    std::set<int> seen(items.begin(), items.end());
    const auto around = [&](std::span<const int> rim, auto&& reach) {
      for (int i : rim)
        for (int j : next[static_cast<std::size_t>(i)]) reach(j);
    };
    grow_layers(items, layers, around, [&](int i) { return seen.insert(i).second; });
    return items;
  };
  EXPECT_EQ(within({0}, 0), (std::vector<int>{0}));
  EXPECT_EQ(within({0}, 1), (std::vector<int>{0, 1}));
  EXPECT_EQ(within({0}, 2), (std::vector<int>{0, 1, 2, 4}));
  EXPECT_EQ(within({0}, kAllLayers), (std::vector<int>{0, 1, 2, 4, 3}));
  EXPECT_EQ(within({3, 0}, 1), (std::vector<int>{3, 0, 2, 1}));
  EXPECT_EQ(within({}, kAllLayers), std::vector<int>{});
}

TEST(GrowLayers, WhatIsNotTakenInLeadsNoFurther) {
  std::vector<int> items = {0};
  const auto around = [](std::span<const int> rim, auto&& reach) {
    for (int i : rim) reach(i + 1);
  };
  grow_layers(items, kAllLayers, around, [](int i) { return i < 5; });
  EXPECT_EQ(items, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(VerticesWithin, AreThoseOfSweepsOverTheWholeMesh) {
  std::size_t n_partial = 0;
  for (const auto& [name, mesh] : test::suite()) {
    for (std::size_t first = 0; first < mesh.n_cells(); first += 7) {
      std::vector<C> cells = {C(first)};
      if (first % 2 == 0) cells.push_back(C(mesh.n_cells() - 1));
      for (const int layers : {0, 1, 2, 4}) {
        const Flags found = vertices_within(mesh, cells, layers);
        ASSERT_EQ(found, flags_by_sweeps(mesh, cells, layers)) << name << " " << first << " " << layers;
        n_partial += n_set(found) < mesh.n_vertices() ? 1 : 0;
      }
    }
  }
  EXPECT_GT(n_partial, 100U) << "nearly every layer is the whole mesh";
}

TEST(VerticesWithin, AskTheCallersTableForCells) {
  const TetMesh mesh = test::kuhn_box(4);
  std::size_t n_asked = 0;
  const auto table = [&](std::span<const VertexHandle> rim, auto&& visit) {
    ++n_asked;
    for_cells_round(mesh, rim, visit);
  };
  const std::vector<C> cells = {C(0)};
  EXPECT_EQ(vertices_within(mesh, cells, 2, table), vertices_within(mesh, cells, 2));
  EXPECT_EQ(n_asked, 2U) << "once a layer";
}

TEST(VerticesWithin, GoOnBeyondAVertexOfTooManyCells) {
  const TetMesh mesh = many_round_an_edge(300);
  ASSERT_GT(mesh.n_cells(), static_cast<std::size_t>(Star::kCapacity));
  const std::vector<C> cells = {C(0)};
  EXPECT_EQ(n_set(vertices_within(mesh, cells, 0)), 4U);
  EXPECT_EQ(n_set(vertices_within(mesh, cells, 1)), mesh.n_vertices());
}

TEST(CellsWithin, AreThoseWithAVertexOfTheLayerBefore) {
  const TetMesh mesh = test::kuhn_box(5);
  for (std::size_t first = 0; first < mesh.n_cells(); first += 11) {
    for (const int layers : {0, 1, 2}) {
      const std::vector<C> found = cells_within(mesh, C(first), layers);
      ASSERT_EQ(found.front(), C(first));
      const std::set<C> cells(found.begin(), found.end());
      ASSERT_EQ(cells.size(), found.size()) << "each once";
      const std::vector<C> centre = {C(first)};
      const Flags before = vertices_within(mesh, centre, std::max(layers - 1, 0));
      std::size_t n = 0;
      for (C c : mesh.cells()) {
        const auto& v = mesh.cell(c).v;
        const bool in = layers == 0 ? c == C(first) : std::any_of(v.begin(), v.end(), [&](VertexHandle w) {
          return before[w.idx()] != 0;
        });
        ASSERT_EQ(cells.contains(c), in) << first << " " << layers;
        n += in ? 1 : 0;
      }
      ASSERT_EQ(n, found.size());
    }
  }
}

TEST(CellsWithin, OuterLayersComeAfterInnerOnes) {
  const TetMesh mesh = test::carved_ball(6);
  const std::vector<C> one = cells_within(mesh, C(mesh.n_cells() / 2), 1);
  const std::vector<C> two = cells_within(mesh, C(mesh.n_cells() / 2), 2);
  ASSERT_LT(one.size(), two.size());
  EXPECT_TRUE(std::equal(one.begin(), one.end(), two.begin()));
}

TEST(CellsWithin, EndAtAnotherRegion) {
  TetMesh mesh = test::kuhn_box(4);
  for (C c : mesh.cells()) {
    double x = 0;
    for (VertexHandle v : mesh.cell(c).v) x += 0.25 * mesh.point(v).x;
    mesh.set_region(c, x < 0.5 ? 1 : 2);
  }
  const std::vector<C> found = cells_within(mesh, C(0), kAllLayers);
  EXPECT_EQ(found.size(), mesh.n_cells() / 2);
  for (C c : found) EXPECT_EQ(mesh.region(c), mesh.region(C(0)));
}

TEST(CellsWithin, VertexOfTooManyCellsLeadsNoFurther) {
  const TetMesh mesh = many_round_an_edge(300);
  // Both other corners lead on to one more cell each.
  EXPECT_EQ(cells_within(mesh, C(5), 1).size(), 3U);
}

}  // namespace
}  // namespace hfr
