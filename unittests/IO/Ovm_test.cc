// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "IO/MeshDataSamples.hh"

namespace hfr::io {
namespace {

using samples::mentions;
using samples::message_of_reading;
using samples::read_text;
using samples::TemporaryFolder;
using ::testing::ElementsAre;

// One tetrahedron as OpenVolumeMesh's add_cell(0, 1, 2, 3) makes it: faces (0 1 2), (0 2 3), (0 3 1), (1 3
// 2).
constexpr const char* kPoints = "OVM ASCII\nVertices\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
constexpr const char* kEdges = "Edges\n6\n0 1\n1 2\n2 0\n2 3\n3 0\n3 1\n";
constexpr const char* kFaces = "Faces\n4\n3 0 2 4\n3 5 6 8\n3 9 10 1\n3 11 7 3\n";

std::string file_of(const std::string& rest) { return std::string(kPoints) + kEdges + kFaces + rest; }

TEST(Ovm, HalfFacesBecomeVerticesInTheirOrder) {
  const MeshData mesh = read_text("a.ovm", file_of("Polyhedra\n1\n4 0 2 4 6\n"));
  EXPECT_THAT(mesh.cells, ElementsAre(std::array<Index, 4>{0, 1, 2, 3}));
  EXPECT_TRUE(mesh.triangles.empty()) << "faces of cells are not elements of their own";
  EXPECT_TRUE(mesh.notes.empty());
}

TEST(Ovm, HalfFacesThatPointOutwardsGiveTheOtherOrientation) {
  const MeshData mesh = read_text("a.ovm", file_of("Polyhedra\n1\n4 1 3 5 7\n"));
  EXPECT_THAT(mesh.cells, ElementsAre(std::array<Index, 4>{1, 0, 2, 3}));
}

TEST(Ovm, PropertiesBecomeFieldsRegionsAndLabels) {
  const MeshData mesh = read_text(
      "a.ovm",
      file_of(
          "Polyhedra\n1\n4 0 2 4 6\nVProp double \"weight of it\"\n1.5\n2\nnan\n4\nCProp vec3i "
          "\"direction\"\n1 -2 3\nCProp int \"hfremesh:region\"\n-7\nVProp string \"note\"\n5:hello\n0:\n"
          "1:x\n1:y\nFProp bool \"hfremesh:element\"\n0\n1\n0\n0\nFProp int \"hfremesh:label\"\n0\n8\n0\n0\n"
          "HFProp float \"flux\"\n1 2 3 4 5 6 7 8\nMProp int \"version\"\n3\n"));
  ASSERT_EQ(mesh.point_fields.size(), 1U);
  EXPECT_EQ(mesh.point_fields[0].name, "weight of it");
  EXPECT_EQ(mesh.point_fields[0].values[3], 4);
  ASSERT_EQ(mesh.cell_fields.size(), 1U);
  EXPECT_TRUE(mesh.cell_fields[0].integer);
  EXPECT_THAT(mesh.cell_fields[0].values, ElementsAre(1, -2, 3));
  EXPECT_THAT(mesh.regions, ElementsAre(-7));
  EXPECT_THAT(mesh.triangles, ElementsAre(std::array<Index, 3>{0, 2, 3}));
  EXPECT_THAT(mesh.triangle_labels, ElementsAre(8));
  EXPECT_EQ(mesh.notes.size(), 3U);
  EXPECT_TRUE(mentions(mesh.notes, "VProp string \"note\""));
  EXPECT_TRUE(mentions(mesh.notes, "HFProp float \"flux\""));
  EXPECT_TRUE(mentions(mesh.notes, "MProp int \"version\""));
}

TEST(Ovm, OfAPropertyGivenTwiceTheLastFixesVertices) {
  const MeshData mesh = read_text("a.ovm", file_of("Polyhedra\n1\n4 0 2 4 6\n"
                                                   "VProp bool \"hfremesh:fixed\"\n1\n1\n0\n0\n"
                                                   "VProp bool \"hfremesh:fixed\"\n0\n1\n0\n0\n"));
  EXPECT_THAT(mesh.fixed_vertices, ElementsAre(1U));
}

TEST(Ovm, TheFileWrittenIsACompleteHalfFaceMesh) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.ovm", samples::two_cells());
  const std::string text = samples::read_bytes(folder / "a.ovm");
  EXPECT_EQ(text,
            "OVM ASCII\nVertices\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n"
            "Edges\n9\n0 1\n1 2\n2 0\n2 3\n3 0\n3 1\n3 4\n4 1\n4 2\n"
            "Faces\n7\n3 0 2 4\n3 5 6 8\n3 9 10 1\n3 11 7 3\n3 11 12 14\n3 15 16 3\n3 17 13 7\n"
            "Polyhedra\n2\n4 0 2 4 6\n4 7 8 10 12\n")
      << "the shared face 3 is half-face 6 of one cell and 7 of the other";
}

TEST(Ovm, RepeatedElementsAreNamed) {
  const TemporaryFolder folder;
  MeshData mesh = samples::two_cells();
  mesh.triangles = {{0, 1, 2}, {2, 1, 0}};
  mesh.triangle_labels = {1, 2};
  EXPECT_TRUE(mentions(write_mesh(folder / "a.ovm", mesh), "1 repeated triangles"));
}

TEST(Ovm, OtherPolyhedraAndOtherFilesAreRefused) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) { return message_of_reading(folder, "a.ovm", text); };
  EXPECT_EQ(message("OVM BINARY\n"), "a.ovm:1: only ASCII files of OpenVolumeMesh are read");
  EXPECT_EQ(message("OVMB\n\r\n\xff"),
            "a.ovm:1: the binary format of OpenVolumeMesh is not read; save the mesh as .ovm");
  EXPECT_EQ(message("ply\n"), "a.ovm:1: not an OpenVolumeMesh file: it does not begin with OVM");
  EXPECT_EQ(message(std::string(kPoints) + kEdges + "Faces\n1\n4 0 2 4 6\n"),
            "a.ovm:18: a face of 4 edges: only tetrahedral meshes are read");
  EXPECT_EQ(message(file_of("Polyhedra\n1\n6 0 2 4 6 1 3\n")),
            "a.ovm:24: a polyhedron of 6 faces: only tetrahedra are read");
}

TEST(Ovm, BrokenFilesAreRefusedWithTheirLine) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) { return message_of_reading(folder, "a.ovm", text); };
  EXPECT_EQ(message(std::string(kPoints) + "Edges\n1\n0 4\n"), "a.ovm:10: vertex 4 is out of range (0 to 3)");
  EXPECT_EQ(message(std::string(kPoints) + kEdges + "Faces\n1\n3 0 1 4\n"),
            "a.ovm:18: the half-edges of face 0 make no triangle");
  EXPECT_EQ(message(file_of("Polyhedra\n1\n4 0 2 4 7\n")),
            "a.ovm:24: the half-faces of cell 0 do not close up to a tetrahedron");
  EXPECT_EQ(message(file_of("Polyhedra\n1\n4 0 0 4 6\n")),
            "a.ovm:24: the half-faces of cell 0 do not close up to a tetrahedron");
  EXPECT_EQ(message(file_of("Polyhedra\n1000000000000000000\n4 0 2 4 6\n")),
            "a.ovm:23: number of polyhedra 1000000000000000000 is more than the rest of the file can hold");
  EXPECT_EQ(message(file_of("Polyhedra\n1\n4 0 2 4 6\nCProp int \"hfremesh:region\"\n0.5\n")),
            "a.ovm:26: a value of property \"hfremesh:region\" is no integer of 32 bits: 0.5");
  EXPECT_EQ(message(file_of("Polyhedra\n1\n4 0 2 4 6\nVProp int \"hfremesh:label\"\n1\n2\n3.5\n4\n\n")),
            "a.ovm:28: a value of property \"hfremesh:label\" is no integer of 32 bits: 3.5");
  EXPECT_EQ(message(file_of("Polyhedra\n1\n4 0 2 4 6\nCProp int \"x\"\n")).substr(0, 7), "a.ovm:2");
}

}  // namespace
}  // namespace hfr::io
