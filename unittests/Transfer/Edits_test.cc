// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer/Edits.hh"

#include <gtest/gtest.h>

#include <cmath>

#include "HalfFace/Geometry.hh"
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
