// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <memory>

#include "CountingNew.hh"
#include "Meshes.hh"

#if HFR_COUNTS_ALLOCATIONS
namespace hfr {
namespace {

/// Allocations made while action runs.
template <class Action>
std::size_t allocations(Action&& action) {
  const std::size_t before = test::n_allocations();
  action();
  return test::n_allocations() - before;
}

std::size_t sum(const auto& range) {
  std::size_t total = 0;
  for (auto item : range) total += item.idx();
  return total;
}

void walk_everything(const TetMesh& mesh, std::size_t& total) {
  total += sum(mesh.vertices()) + sum(mesh.edges()) + sum(mesh.halfedges()) + sum(mesh.faces()) +
           sum(mesh.halffaces()) + sum(mesh.cells());
  total += sum(mesh.boundary_vertices()) + sum(mesh.boundary_edges()) + sum(mesh.boundary_halfedges()) +
           sum(mesh.boundary_faces()) + sum(mesh.boundary_cells()) + sum(mesh.boundary_halffaces());
  for (VertexHandle v : mesh.vertices())
    total += sum(mesh.vertex_cells(v)) + sum(mesh.vertex_vertices(v)) + sum(mesh.vertex_edges(v)) +
             sum(mesh.vertex_faces(v)) + sum(mesh.vertex_halffaces(v)) + sum(mesh.outgoing_halfedges(v)) +
             sum(mesh.incoming_halfedges(v)) + mesh.valence(v);
  for (EdgeHandle e : mesh.edges())
    total +=
        sum(mesh.edge_cells(e)) + sum(mesh.edge_faces(e)) + sum(mesh.edge_halffaces(e)) + mesh.valence(e);
  for (HalfEdgeHandle e : mesh.halfedges())
    total += sum(mesh.halfedge_cells(e)) + sum(mesh.halfedge_faces(e)) + sum(mesh.halfedge_halffaces(e));
  for (CellHandle c : mesh.cells())
    total += sum(mesh.cell_cells(c)) + sum(mesh.cell_vertices(c)) + sum(mesh.cell_edges(c)) +
             sum(mesh.cell_halfedges(c)) + sum(mesh.cell_faces(c)) + sum(mesh.cell_halffaces(c));
  for (FaceHandle f : mesh.faces())
    total += sum(mesh.face_cells(f)) + sum(mesh.face_halffaces(f)) + sum(mesh.face_edges(f));
  for (HalfFaceHandle h : mesh.halffaces()) {
    total += sum(mesh.halfface_vertices(h)) + sum(mesh.halfface_halfedges(h));
    total += mesh.find_halfface(mesh.halfface_vertices(h)).idx();
    if (mesh.is_boundary(h)) total += sum(mesh.boundary_halfface_halffaces(h));
  }
  total += mesh.n_edges() + mesh.n_faces();
}

TEST(Allocation, CounterCounts) {
  EXPECT_EQ(allocations([] { std::vector<int>(100).swap(*std::make_unique<std::vector<int>>(7)); }), 3U);
}

TEST(Allocation, NoQueryAllocates) {
  for (const auto& [name, mesh] : test::suite()) {
    std::size_t total = 0;
    EXPECT_EQ(allocations([&, &mesh = mesh] { walk_everything(mesh, total); }), 0U) << name;
    EXPECT_GT(total, 0U);
  }
}

TEST(Allocation, NorRoundAVertexOfManyCells) {
  std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
  std::vector<test::Corners> cells;
  constexpr Index kCells = 300;
  for (Index i = 0; i < kCells; ++i) {
    points.push_back({std::cos(i * 0.02), std::sin(i * 0.02), 0});
    cells.push_back({0, 1, 2 + i, 2 + (i + 1) % kCells});
  }
  const TetMesh mesh = build(points, cells);
  ASSERT_GT(kCells, static_cast<Index>(Star::kCapacity));
  std::size_t total = 0;
  EXPECT_EQ(allocations([&] { walk_everything(mesh, total); }), 0U);
}

TEST(MemoryBytes, CountsWhatWasReserved) {
  const TetMesh mesh = test::kuhn_box(6);
  const std::size_t least =
      mesh.n_cells() * sizeof(Cell) + mesh.n_vertices() * (sizeof(Vec3) + sizeof(CellHandle) + 1);
  EXPECT_GE(mesh.memory_bytes(), least);
  EXPECT_LT(mesh.memory_bytes(), least + least / 8);  // room for some more cells
  TetMesh more = mesh;
  const std::size_t before = more.memory_bytes();
  more.request_cell_property<double>("p");
  EXPECT_GE(more.memory_bytes(), before + 8 * mesh.n_cells());
}

}  // namespace
}  // namespace hfr
#endif
