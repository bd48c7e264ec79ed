// SPDX-License-Identifier: BSD-3-Clause
#include "IO/ReadWrite.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "HalfFace/Check.hh"
#include "HalfFace/Generate.hh"
#include "IO/MeshDataSamples.hh"

namespace hfr::io {
namespace {

using samples::TemporaryFolder;

/// Two regions, named patches, a labelled edge, a fixed vertex, and fields on both kinds of things.
TetMesh full() {
  const generate::Arrays box = generate::box({2, 2, 2});
  TetMesh mesh = build(box.points, box.cells);
  auto heat = mesh.request_vertex_property<double>("heat", 0.0);
  auto flow = mesh.request_cell_property<Vec3>("flow", Vec3{});
  for (VertexHandle v : mesh.vertices()) heat[v] = mesh.point(v).x;
  for (CellHandle c : mesh.cells()) flow[c] = {double(c.idx()), 1, 2};
  for (CellHandle c : mesh.cells()) mesh.set_region(c, c.idx() % 2 == 0 ? 3 : 4);
  for (FaceHandle f : mesh.boundary_faces()) mesh.labels().faces.set(mesh.face_vertices(f), 9);
  mesh.labels().edges.set(mesh.edge_vertices(*mesh.boundary_edges().begin()), 5);
  mesh.labels().names[{2, 9}] = "skin";
  mesh.set_fixed(VertexHandle(13));
  return mesh;
}

TEST(ReadWrite, EverythingAttachedComesBackThroughOneCallEach) {
  const TemporaryFolder folder;
  const TetMesh mesh = full();
  for (const char* name : {"box.vtu", "box.mesh", "box.msh"}) {
    const std::vector<std::string> lost = write(folder / name, mesh);
    ReadReport report;
    const TetMesh back = read(folder / name, {}, &report);
    EXPECT_FALSE(report.build.flipped);
    ASSERT_EQ(check(back), Ok);
    ASSERT_EQ(back.n_cells(), mesh.n_cells());
    for (CellHandle c : mesh.cells()) {
      EXPECT_EQ(back.region(c), mesh.region(c)) << name;
      EXPECT_EQ(back.cell(c).v, mesh.cell(c).v) << name;
    }
    EXPECT_EQ(back.labels().faces.size(), mesh.labels().faces.size()) << name;
    if (!lost.empty()) continue;  // the format says what it cannot hold
    const auto heat = back.get_vertex_property<double>("heat");
    ASSERT_TRUE(heat.has_value()) << name;
    for (VertexHandle v : mesh.vertices()) EXPECT_EQ((*heat)[v], mesh.point(v).x);
    ASSERT_TRUE(back.get_cell_property<Vec3>("flow").has_value()) << name;
  }
}

TEST(ReadWrite, WhatIsDeletedAndWhatHasNoNameStaysOut) {
  const TemporaryFolder folder;
  TetMesh mesh = full();
  const auto scratch = mesh.request_vertex_property<double>();
  mesh.delete_vertex(VertexHandle(0));
  write(folder / "torn.vtu", mesh);
  const TetMesh back = read(folder / "torn.vtu");
  EXPECT_EQ(back.n_vertices(), mesh.n_logical_vertices());
  EXPECT_EQ(back.n_cells(), mesh.n_logical_cells());
  EXPECT_THAT(back.properties().vertices.names(), testing::ElementsAre("heat"));
}

TEST(ReadWrite, ErrorsNameTheFile) {
  const TemporaryFolder folder;
  const auto message = [&](const char* name, const char* text) {
    std::ofstream(folder / name) << text;
    try {
      read(folder / name);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message("none.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\nEnd\n"),
              testing::AllOf(testing::HasSubstr("none.mesh: "), testing::HasSubstr("no tetrahedra")));
  const char* three =
      "MeshVersionFormatted 2\nDimension 3\nVertices 6\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
      "0 0 -1 0\n1 1 1 0\nTetrahedra 3\n1 2 3 4 0\n1 2 3 5 0\n1 2 3 6 0\nEnd\n";
  EXPECT_THAT(message("three.mesh", three),
              testing::AllOf(testing::HasSubstr("three.mesh: "), testing::HasSubstr("more than two cells")));
  EXPECT_THROW(read(folder / "missing.vtu"), IoError);
  EXPECT_THROW(write(folder / "box.xyz", full()), InvalidInput);
}

}  // namespace
}  // namespace hfr::io
