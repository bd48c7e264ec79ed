// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/MapRecorder.hh"

#include <gtest/gtest.h>

#include "HalfFace/Reorder.hh"
#include "Remesh/Meshes.hh"

namespace hfr::test {
namespace {

/// Maps are inverse to each other, cells that are kept have the mapped vertices, and vertices that did not
/// move are where they were. Returns how many cells are kept.
std::size_t expect_maps(const TetMesh& before, const TetMesh& after, const MeshMaps& maps) {
  EXPECT_EQ(maps.vertices.size(), before.n_vertices());
  EXPECT_EQ(maps.cells.size(), before.n_cells());
  EXPECT_EQ(maps.old_vertices.size(), after.n_vertices());
  EXPECT_EQ(maps.old_cells.size(), after.n_cells());
  EXPECT_EQ(maps.sources.size(), after.n_vertices());
  std::size_t n_kept = 0;
  for (std::size_t i = 0; i < maps.vertices.size(); ++i) {
    if (!maps.vertices[i].is_valid()) continue;
    EXPECT_EQ(maps.old_vertices[maps.vertices[i].idx()], V(i));
    EXPECT_EQ(maps.sources[maps.vertices[i].idx()], V(i));
  }
  for (std::size_t i = 0; i < maps.old_vertices.size(); ++i) {
    if (maps.old_vertices[i].is_valid()) {
      EXPECT_EQ(maps.vertices[maps.old_vertices[i].idx()], V(i));
    } else {
      EXPECT_LT(maps.sources[i].idx(), before.n_vertices());
    }
  }
  for (std::size_t i = 0; i < maps.cells.size(); ++i) {
    if (!maps.cells[i].is_valid()) continue;
    ++n_kept;
    EXPECT_EQ(maps.old_cells[maps.cells[i].idx()], C(i));
    std::set<VertexHandle> mapped;
    for (VertexHandle v : before.cell(C(i)).v) mapped.insert(maps.vertices[v.idx()]);
    const auto& now = after.cell(maps.cells[i]).v;
    EXPECT_EQ(mapped, std::set<VertexHandle>(now.begin(), now.end())) << "cell " << i;
  }
  for (std::size_t i = 0; i < maps.old_cells.size(); ++i)
    if (maps.old_cells[i].is_valid()) {
      EXPECT_EQ(maps.cells[maps.old_cells[i].idx()], C(i));
    }
  return n_kept;
}

TEST(MeshMaps, OfARunTowardsAGoalMostCellsAreKeptAndWhatIsNotMovedIsWhereItWas) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    TetMesh mesh = small_cavity(8);
    const TetMesh before = mesh;
    ImproveOptions options = serial();
    options.min_dihedral = 15;
    options.maps = true;
    options.seed = seed;
    const Result result = improve(mesh, options);
    ASSERT_TRUE(result.changed);
    EXPECT_GT(expect_maps(before, mesh, result.maps), before.n_cells() / 2);
    const auto frozen = frozen_vertices(before);
    std::size_t n_moved = 0, n_same = 0;
    for (std::size_t i = 0; i < before.n_vertices(); ++i) {
      if (frozen[i]) {
        EXPECT_TRUE(result.maps.vertices[i].is_valid());
      }
      if (!result.maps.vertices[i].is_valid()) continue;
      const bool same = mesh.point(result.maps.vertices[i]) == before.point(V(i));
      if (frozen[i]) {
        EXPECT_TRUE(same);
      }
      ++(same ? n_same : n_moved);
    }
    EXPECT_GT(n_same, before.n_vertices() / 2);
    EXPECT_GT(n_moved, 0U);
    EXPECT_TRUE(mesh.properties().vertices.names().empty());
  }
}

TEST(MeshMaps, InsertedVerticesNameTheOneWhosePropertiesTheyHave) {
  TetMesh mesh = built(generate::cylinder(2, 6, 1, 2, 60));
  auto number = mesh.request_vertex_property<Index>("number");
  for (VertexHandle v : mesh.vertices()) number[v] = v.idx();
  const TetMesh before = mesh;
  ImproveOptions options = serial();
  options.raise_min_dihedral = true;
  options.maps = true;
  const Result result = improve(mesh, options);
  expect_maps(before, mesh, result.maps);
  std::size_t n_inserted = 0;
  for (VertexHandle v : mesh.vertices()) {
    n_inserted += result.maps.old_vertices[v.idx()].is_valid() ? 0 : 1;
    EXPECT_EQ(result.maps.sources[v.idx()].idx(), number[v]);
  }
  EXPECT_GT(n_inserted, 0U);
}

TEST(MeshMaps, ScatteredMeshesThatAreReorderedForTheRunAreMappedAllTheSame) {
  // Cells in an order in which neighbours are far apart.
  generate::Arrays arrays = generate::jittered_box({20, 20, 20}, 0.2, 3);
  std::vector<std::array<Index, 4>> cells(arrays.cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i * 23017 % cells.size()] = arrays.cells[i];
  TetMesh mesh = build(arrays.points, cells);
  ASSERT_TRUE(is_scattered(mesh));
  const TetMesh before = mesh;
  ImproveOptions options = serial();
  options.maps = true;
  options.iterations = 1;
  options.ops = Ops::kFace;
  const Result result = improve(mesh, options);
  ASSERT_TRUE(result.changed);
  EXPECT_GT(expect_maps(before, mesh, result.maps), before.n_cells() / 2);
}

TEST(MeshMaps, CellThatCameAgainWithThePropertiesOfAnotherIsNotKept) {
  TetMesh mesh = small_cavity(4);
  auto value = mesh.request_cell_property<int>("value");
  const std::vector<std::string> names = mesh.properties().cells.names();
  {
    MapRecorder recorder(mesh);
    mesh.copy_cell_data(C(3), C(7));  // what a round does for a cell in a slot that had been freed
    const MeshMaps maps = recorder.maps({}, {});
    for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
      EXPECT_EQ(maps.cells[i], i == 7 ? CellHandle() : C(i));
      EXPECT_EQ(maps.old_cells[i], i == 7 ? CellHandle() : C(i));
    }
  }
  EXPECT_EQ(mesh.properties().cells.names(), names);
}

TEST(MeshMaps, CellThatCameAgainHasItsPropertiesBackWhereTheMeshAsItWasIsAtHand) {
  TetMesh mesh = small_cavity(4);
  auto value = mesh.request_cell_property<int>("value");
  auto name = mesh.request_cell_property<std::string>("name");
  for (CellHandle c : mesh.cells()) value[c] = static_cast<int>(c.idx()), name[c] = std::to_string(c.idx());
  const TetMesh before = mesh;
  MapRecorder recorder(mesh, &before);
  mesh.copy_cell_data(C(3), C(7));
  ASSERT_EQ(value[C(7)], 3);
  const MeshMaps maps = recorder.maps({}, {});
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    EXPECT_EQ(maps.cells[i], C(i));
    EXPECT_EQ(value[C(i)], static_cast<int>(i));
    EXPECT_EQ(name[C(i)], std::to_string(i));
  }
}

TEST(MeshMaps, KeptCellsHaveThePropertiesThatTheyHad) {
  for (const SurfaceMode mode : {SurfaceMode::kFrozen, SurfaceMode::kFlat, SurfaceMode::kFree}) {
#ifndef HFR_HAS_SURFACE
    if (mode != SurfaceMode::kFrozen) continue;
#endif
    TetMesh mesh = small_cavity(8);
    auto number = mesh.request_cell_property<std::size_t>("number");
    for (CellHandle c : mesh.cells()) number[c] = c.idx();
    ImproveOptions options = serial();
    options.maps = true;
    options.surface.mode = mode;
    const Result result = improve(mesh, options);
    std::size_t n_kept = 0;
    for (CellHandle c : mesh.cells()) {
      const CellHandle old = result.maps.old_cells[c.idx()];
      if (!old.is_valid()) continue;
      ++n_kept;
      EXPECT_EQ(number[c], old.idx());
    }
    EXPECT_GT(n_kept, 100U);
  }
}

TEST(MeshMaps, MeshThatStaysIsMappedToItself) {
  TetMesh mesh = jittered(4, 0.05, 1);
  ImproveOptions options = serial();
  options.min_dihedral = 20;
  options.maps = true;
  const Result result = improve(mesh, options);
  ASSERT_FALSE(result.changed);
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) EXPECT_EQ(result.maps.vertices[i], V(i));
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) EXPECT_EQ(result.maps.cells[i], C(i));
}

TEST(MeshMaps, HandlesThatWereDeletedBeforeTheRunMapToNothing) {
  for (const double goal : {30.0, 1e-3}) {  // one that takes work, and one that is met
    TetMesh mesh = jittered(5, 0.3, 2);
    mesh.delete_vertex(V(0));
    mesh.delete_cell(C(40));
    const TetMesh before = mesh;
    ImproveOptions options = serial();
    options.maps = true;
    options.min_dihedral = goal;
    const Result result = improve(mesh, options);
    ASSERT_EQ(result.changed, goal == 30);
    EXPECT_FALSE(mesh.needs_garbage_collection());
    EXPECT_FALSE(result.maps.vertices[0].is_valid());
    EXPECT_FALSE(result.maps.cells[40].is_valid());
    EXPECT_GT(expect_maps(before, mesh, result.maps), goal == 30 ? 0 : before.n_logical_cells() - 1);
  }
}

}  // namespace
}  // namespace hfr::test
