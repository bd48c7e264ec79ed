// SPDX-License-Identifier: BSD-3-Clause
#include "IO/Assemble.hh"

#include <gtest/gtest.h>

#include "HalfFace/Check.hh"
#include "HalfFace/Generate.hh"
#include "HalfFace/Writer.hh"

namespace hfr::io {
namespace {

/// A box of two regions with labels of every kind.
MeshData labelled_box() {
  generate::Arrays box = generate::two_region_box({4, 3, 2});
  MeshData data;
  data.points = std::move(box.points);
  data.cells = std::move(box.cells);
  data.regions = std::move(box.regions);
  const TetMesh mesh = build(data.points, data.cells);
  for (std::size_t h = 0; h < 4 * mesh.n_cells(); ++h) {
    if (mesh.opposite_halfface(HalfFaceHandle(h)).is_valid()) continue;
    const auto [a, b, c] = mesh.halfface_vertices(HalfFaceHandle(h));
    data.triangles.push_back(h % 3 == 0 ? std::array{a.idx(), c.idx(), b.idx()}
                                        : std::array{a.idx(), b.idx(), c.idx()});
    data.triangle_labels.push_back(static_cast<int>(h % 5));
  }
  data.edges = {{1, 0}, {1, 2}, {5, 0}};
  data.edge_labels = {7, 0, -3};
  data.vertex_labels.assign(data.points.size(), 0);
  data.vertex_labels[3] = 9;
  data.fixed_vertices = {0, 3, 59};
  data.names = {{{3, 1}, "steel"}, {{2, 4}, "inlet"}};
  return data;
}

void expect_equal(const MeshData& a, const MeshData& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.regions, b.regions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.triangle_labels, b.triangle_labels);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.edge_labels, b.edge_labels);
  EXPECT_EQ(a.vertex_labels, b.vertex_labels);
  EXPECT_EQ(a.fixed_vertices, b.fixed_vertices);
  EXPECT_EQ(a.names, b.names);
}

TEST(Assemble, EverythingComesBackAsItWentIn) {
  const MeshData data = labelled_box();
  std::vector<std::string> notes;
  for (const int threads : {1, 3}) {
    const par::Policy policy{threads, 1};
    expect_equal(data, disassemble(assemble(data, policy, nullptr, &notes), policy));
  }
  EXPECT_TRUE(notes.empty());
}

TEST(Assemble, WhatAFileSaysIsWhatTheMeshAnswers) {
  const MeshData data = labelled_box();
  const TetMesh mesh = assemble(data);
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) EXPECT_EQ(mesh.region(CellHandle(c)), data.regions[c]);
  EXPECT_TRUE(mesh.is_fixed(VertexHandle(59)));
  EXPECT_FALSE(mesh.is_fixed(VertexHandle(58)));
  EXPECT_EQ(mesh.labels().vertex(VertexHandle(3)), 9);
  EXPECT_TRUE(mesh.is_labelled_edge(VertexHandle(0), VertexHandle(5)));
  EXPECT_FALSE(mesh.is_labelled_edge(VertexHandle(0), VertexHandle(2)));
}

TEST(Assemble, MeshWithoutLabelsStaysWithoutThem) {
  generate::Arrays box = generate::box({2, 2, 2});
  MeshData data;
  data.points = box.points;
  data.cells = box.cells;
  data.regions.assign(box.cells.size(), 0);
  data.vertex_labels.assign(box.points.size(), 0);
  const MeshData back = disassemble(assemble(data));
  EXPECT_TRUE(back.regions.empty());
  EXPECT_TRUE(back.vertex_labels.empty());
  EXPECT_TRUE(back.triangles.empty());
  EXPECT_TRUE(back.fixed_vertices.empty());
}

TEST(Assemble, DeletedCellsAndVerticesAreLeftOutAndTheRestKeepsItsOrder) {
  const MeshData data = labelled_box();
  TetMesh mesh = assemble(data);
  const CellHandle gone(5);
  TetMesh::Writer(mesh).mark_deleted(gone);
  TetMesh::Writer(mesh).free_cells().push_back(gone);
  TetMesh::Writer(mesh).mark_deleted(VertexHandle(0));  // as if no cell had used it
  const MeshData left = disassemble(mesh, {2, 1});
  EXPECT_EQ(left.points.size(), data.points.size() - 1);
  EXPECT_EQ(left.cells.size(), data.cells.size() - 1);
  EXPECT_EQ(left.regions.size(), left.cells.size());
  EXPECT_EQ(left.points[0], data.points[1]);
  EXPECT_EQ(left.cells[5][3], data.cells[6][3] - 1);
  EXPECT_EQ(left.edges, (std::vector<std::array<Index, 2>>{{0, 1}}));  // the others ended at vertex 0
  EXPECT_EQ(left.edge_labels, (std::vector<int>{0}));
  EXPECT_EQ(left.fixed_vertices, (std::vector<Index>{2, 58}));
  EXPECT_EQ(left.vertex_labels[2], 9);
}

TEST(Assemble, TrianglesGivenTwiceAreReported) {
  MeshData data = labelled_box();
  const std::size_t n = data.triangles.size();
  const auto [a, b, c] = data.triangles[4];
  data.triangles.push_back({c, b, a});
  data.triangle_labels.push_back(77);
  std::vector<std::string> notes;
  const MeshData back = disassemble(assemble(data, {}, nullptr, &notes));
  EXPECT_EQ(back.triangles.size(), n);
  EXPECT_EQ(back.triangle_labels[4], 77);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0], "triangles given more than once: 1; the last label of each counts");
}

TEST(Assemble, FileInTheOtherOrientationIsFlippedAsAWhole) {
  MeshData data = labelled_box();
  for (auto& cell : data.cells) std::swap(cell[0], cell[1]);
  BuildReport report;
  const MeshData back = disassemble(assemble(data, {}, &report));
  EXPECT_TRUE(report.flipped);
  EXPECT_TRUE(report.reoriented.empty());
  EXPECT_EQ(back.triangles, data.triangles);
}

TEST(Assemble, WhatVerticesHaveGoesToTheirCopies) {
  // Two cells along the edge (0, 1), and what a file may say of it.
  MeshData data;
  data.points = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  data.cells = {{0, 1, 2, 3}, {0, 1, 4, 5}};
  data.regions = {3, 4};
  data.triangles = {{0, 1, 2}, {4, 1, 0}, {2, 3, 1}};
  data.triangle_labels = {7, 8, 9};
  data.edges = {{1, 0}, {2, 3}};
  data.edge_labels = {5, 6};
  data.vertex_labels = {0, 11, 0, 0, 0, 0};
  data.fixed_vertices = {0};
  Field field;
  field.name = "u";
  field.components = 2;
  for (int i = 0; i < 12; ++i) field.values.push_back(i);
  data.point_fields = {field};
  BuildReport report;
  const TetMesh mesh = assemble(data, {}, &report, nullptr, NonManifold::kSplit);
  EXPECT_EQ(check(mesh), Ok);
  EXPECT_EQ(report.copied, (std::vector{VertexHandle(0), VertexHandle(1)}));
  const MeshData back = disassemble(mesh);
  EXPECT_EQ(back.cells[1], (std::array<Index, 4>{6, 7, 4, 5}));
  EXPECT_EQ(back.points[7], data.points[1]);
  EXPECT_EQ(back.triangles, (std::vector<std::array<Index, 3>>{{0, 1, 2}, {4, 7, 6}, {2, 3, 1}}));
  EXPECT_EQ(back.triangle_labels, data.triangle_labels);
  EXPECT_EQ(back.edges, (std::vector<std::array<Index, 2>>{{1, 0}, {7, 6}, {2, 3}}));
  EXPECT_EQ(back.edge_labels, (std::vector<int>{5, 5, 6}));
  EXPECT_EQ(back.vertex_labels, (std::vector<int>{0, 11, 0, 0, 0, 0, 0, 11}));
  EXPECT_EQ(back.fixed_vertices, (std::vector<Index>{0, 6}));
  ASSERT_EQ(back.point_fields.size(), 1U);
  EXPECT_EQ(back.point_fields[0].values,
            (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3}));
}

TEST(Assemble, RegionsThatDoNotFitTheCellsAreRefused) {
  MeshData data = labelled_box();
  data.regions.pop_back();
  EXPECT_THROW(assemble(data), InvalidInput);
}

}  // namespace
}  // namespace hfr::io
