// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Edits.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "HalfFace/Geometry.hh"
#include "HalfFace/Writer.hh"
#include "Transfer/Gradients.hh"
#include "Transfer/TwoMeshes.hh"

namespace hfr::test {
namespace {

std::vector<std::array<VertexHandle, 4>> cells_of(const TetMesh& mesh) {
  std::vector<std::array<VertexHandle, 4>> out;
  for (CellHandle c : mesh.cells()) out.push_back(mesh.cell_vertices(c));
  return out;
}

TEST(Edits, AppliedToTheOldArraysGiveTheNewOnes) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TwoMeshes two(5, 0.15, seed);
    const Edits edits = two.edits();
    EXPECT_EQ(edits.cell_vertices(cells_of(two.old)), cells_of(two.now));
    const std::vector<Vec3> points = edits.points(two.old.points());
    EXPECT_TRUE(std::equal(points.begin(), points.end(), two.now.points().begin(), two.now.points().end()));
    EXPECT_FALSE(edits.created_cells.empty());
    EXPECT_FALSE(edits.removed_cells.empty());
    EXPECT_FALSE(edits.created_vertices.empty());
    EXPECT_FALSE(edits.removed_vertices.empty());
    EXPECT_FALSE(edits.moved_vertices.empty());
    EXPECT_FALSE(edits.moved_cells.empty());
  }
}

TEST(Edits, WhatIsNotListedIsAsItWas) {
  const TwoMeshes two;
  const Edits edits = two.edits();
  EXPECT_EQ(two.old.n_cells() - edits.removed_cells.size() + edits.created_cells.size(), two.now.n_cells());
  EXPECT_EQ(two.old.n_vertices() - edits.removed_vertices.size() + edits.created_vertices.size(),
            two.now.n_vertices());
  std::vector<std::uint8_t> listed(two.now.n_vertices(), 0);
  for (const PlacedVertex& v : edits.created_vertices) listed[v.vertex.idx()] = 1;
  for (const PlacedVertex& v : edits.moved_vertices) listed[v.vertex.idx()] = 1;
  for (VertexHandle v : two.now.vertices())
    if (!listed[v.idx()]) {
      ASSERT_EQ(two.now.point(v), two.old.point(edits.maps.old_vertices[v.idx()]));
    }
}

/// The cell that a vertex names as one of its own is what is left of how the mesh was made.
TEST(Edits, DoNotDependOnHowTheMeshesAreStored) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TwoMeshes one(5, 0.15, seed);
    TwoMeshes other = one;
    for (TetMesh* mesh : {&other.old, &other.now}) {
      TetMesh::Writer writer(*mesh);
      for (CellHandle c : mesh->cells())
        for (VertexHandle v : mesh->cell(c).v) writer.set_incident_cell(v, c);
    }
    const Edits a = one.edits(), b = other.edits();
    const auto expect_same = [](const std::vector<PlacedVertex>& x, const std::vector<PlacedVertex>& y) {
      ASSERT_EQ(x.size(), y.size());
      for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_EQ(x[i].near_vertex, y[i].near_vertex);
        EXPECT_EQ(x[i].old_cell, y[i].old_cell);
        EXPECT_EQ(x[i].weights, y[i].weights);
      }
    };
    expect_same(a.created_vertices, b.created_vertices);
    expect_same(a.moved_vertices, b.moved_vertices);
    ASSERT_EQ(a.parents().first, b.parents().first);
    for (std::size_t i = 0; i < a.parents().all.size(); ++i)
      EXPECT_EQ(a.parents().all[i].share, b.parents().all[i].share);
    std::vector<CellHandle> cells;
    for (const PlacedVertex& v : a.moved_vertices) cells.push_back(v.old_cell);
    const Gradients of_one(one.old, cells, {}), of_other(other.old, cells, {});
    std::size_t n_terms = 0;
    for (VertexHandle v : one.old.vertices()) {
      const auto x = of_one.terms(v), y = of_other.terms(v);
      ASSERT_EQ(x.size(), y.size());
      for (std::size_t i = 0; i < x.size(); ++i, ++n_terms) {
        EXPECT_EQ(x[i].neighbour, y[i].neighbour);
        EXPECT_EQ(x[i].weight, y[i].weight);
      }
    }
    EXPECT_GT(n_terms, 100U);
  }
}

TEST(Edits, CreatedVerticesAreLookedForFromTheirNearestOldNeighbours) {
  const TwoMeshes two(5, 0.15, 2);
  const Edits edits = two.edits();
  ASSERT_FALSE(edits.created_vertices.empty());
  for (const PlacedVertex& v : edits.created_vertices) {
    VertexHandle nearest;
    double least = std::numeric_limits<double>::infinity();
    for (VertexHandle u : two.now.vertex_vertices(v.vertex))
      if (const double d = norm(two.now.point(u) - v.point);
          d < least && edits.maps.old_vertices[u.idx()].is_valid())
        least = d, nearest = edits.maps.old_vertices[u.idx()];
    EXPECT_EQ(v.near_vertex, nearest);
  }
  for (const PlacedVertex& v : edits.moved_vertices) EXPECT_EQ(v.near_vertex, v.old_vertex);
}

/// A cell within which four vertices are new: the innermost one has no old neighbours.
TEST(Edits, VerticesThatHaveNewNeighboursAloneAreLookedForFromTheirs) {
  TwoMeshes two(1, 0, 1);
  two.old = build(std::vector<Vec3>{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}},
                  std::vector<std::array<Index, 4>>{{0, 1, 2, 3}});
  two.now = two.old;
  CellHandle c(0);
  std::vector<VertexHandle> made;
  for (int i = 0; i < 5; ++i) {
    made.push_back(two.now.split_cell(c));
    // The next one goes where as many corners as can be are new.
    std::size_t best = 0;
    for (CellHandle d : two.now.cells()) {
      const auto& v = two.now.cell(d).v;
      const auto n = static_cast<std::size_t>(
          std::count_if(v.begin(), v.end(), [](VertexHandle u) { return u.idx() > 3; }));
      if (n >= best) best = n, c = d;
    }
  }
  two.maps = {};
  for (std::size_t i = 0; i < two.now.n_vertices(); ++i) {
    two.maps.old_vertices.push_back(i < 4 ? VertexHandle(i) : VertexHandle());
    two.maps.sources.push_back(VertexHandle(i < 4 ? i : 0));
    if (i < 4) two.maps.vertices.push_back(VertexHandle(i));
  }
  two.maps.cells.assign(1, {});
  two.maps.old_cells.assign(two.now.n_cells(), {});
  const Edits edits = two.edits();
  ASSERT_EQ(edits.created_vertices.size(), 5U);
  bool any_among_new_ones = false;
  for (const PlacedVertex& v : edits.created_vertices) {
    EXPECT_TRUE(v.near_vertex.is_valid());
    EXPECT_TRUE(v.inside);
    EXPECT_EQ(v.old_cell, CellHandle(0));
    bool has_old_one = false;
    for (VertexHandle u : two.now.vertex_vertices(v.vertex)) has_old_one = has_old_one || u.idx() < 4;
    any_among_new_ones = any_among_new_ones || !has_old_one;
  }
  EXPECT_TRUE(any_among_new_ones);
}

TEST(Edits, SharesOfTheParentsOfACreatedCellAddUpToOneTheLargestFirst) {
  const TwoMeshes two;
  const Edits edits = two.edits();
  for (std::size_t i = 0; i < edits.created_cells.size(); ++i) {
    ASSERT_FALSE(edits.parents().of(i).empty());
    double sum = 0, last = 2;
    for (const ParentCell& parent : edits.parents().of(i)) {
      sum += parent.share;
      EXPECT_LE(parent.share, last);
      last = parent.share;
    }
    EXPECT_NEAR(sum, 1, 1e-11);
  }
}

TEST(Edits, WeightsOfACreatedVertexGiveItsPlace) {
  const TwoMeshes two;
  const Edits edits = two.edits();
  for (const auto* list : {&edits.created_vertices, &edits.moved_vertices})
    for (const PlacedVertex& v : *list) {
      EXPECT_TRUE(v.inside);
      Vec3 sum;
      for (std::size_t k = 0; k < 4; ++k)
        sum = sum + v.weights[k] * two.old.point(two.old.cell_vertices(v.old_cell)[k]);
      EXPECT_NEAR(norm(sum - v.point), 0, 1e-14);
    }
}

TEST(Edits, CellWithItsVerticesInAnotherOrderIsANewOne) {
  TwoMeshes two(2, 0, 1);
  two.now = two.old;
  MeshMaps maps;
  for (VertexHandle v : two.old.vertices()) maps.vertices.push_back(v);
  for (CellHandle c : two.old.cells()) maps.cells.push_back(c);
  maps.old_vertices = maps.sources = maps.vertices;
  maps.old_cells = maps.cells;
  EXPECT_TRUE(make_edits(two.old, two.now, maps, {}).empty());
  auto cells = cells_of(two.old);
  std::rotate(cells[5].begin(), cells[5].begin() + 1, cells[5].begin() + 3);
  std::vector<std::array<Index, 4>> indices;
  for (const auto& c : cells) indices.push_back({c[0].idx(), c[1].idx(), c[2].idx(), c[3].idx()});
  two.now = build(std::vector<Vec3>(two.old.points().begin(), two.old.points().end()), indices);
  const Edits edits = make_edits(std::make_shared<TetMesh>(two.old), two.now, maps, {});
  ASSERT_EQ(edits.created_cells.size(), 1U);
  EXPECT_EQ(edits.created_cells[0].cell, CellHandle(5));
  const auto parents = edits.parents().of(0);
  ASSERT_EQ(parents.size(), 1U);
  EXPECT_EQ(parents[0].old_cell, CellHandle(5));
  EXPECT_NEAR(parents[0].share, 1, 1e-14);
}

}  // namespace
}  // namespace hfr::test
