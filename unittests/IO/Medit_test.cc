// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "IO/MeshDataSamples.hh"

namespace hfr::io {
namespace {

using samples::mentions;
using samples::message_of_reading;
using samples::read_text;
using samples::TemporaryFolder;
using ::testing::ElementsAre;

constexpr const char* kHead = "MeshVersionFormatted 2\nDimension\n3\n";
constexpr const char* kPoints = "Vertices 5\n0 0 0 0\n1 0 0 4\n0 1 0 0\n0 0 1 0\n1 1 1 0\n";
constexpr const char* kCells = "Tetrahedra 2\n1 2 3 4 3\n2 3 4 5 7\n";

std::string file_of(const std::string& sections) { return kHead + std::string(kPoints) + sections; }

TEST(Medit, PointsCellsAndTheirReferences) {
  const MeshData mesh = read_text("a.mesh", file_of(std::string(kCells) + "End\n"));
  ASSERT_EQ(mesh.points.size(), 5U);
  EXPECT_EQ(mesh.points[4], (Vec3{1, 1, 1}));
  EXPECT_THAT(mesh.vertex_labels, ElementsAre(0, 4, 0, 0, 0));
  EXPECT_THAT(mesh.cells, ElementsAre(std::array<Index, 4>{0, 1, 2, 3}, std::array<Index, 4>{1, 2, 3, 4}));
  EXPECT_THAT(mesh.regions, ElementsAre(3, 7));
  EXPECT_TRUE(mesh.notes.empty());
}

TEST(Medit, CommentsAndLineBreaksMayStandAnywhere) {
  const MeshData mesh =
      read_text("a.mesh",
                "MeshVersionFormatted # two\r\n 2 Dimension 3 Vertices 1 # one\n\n0.5 1.5D0\n-2 7 "
                "Triangles\n# none\n0\n End");
  ASSERT_EQ(mesh.points.size(), 1U);
  EXPECT_EQ(mesh.points[0], (Vec3{0.5, 1.5, -2}));
  EXPECT_TRUE(mesh.notes.empty());
}

TEST(Medit, WithoutEndTheMeshIsReadAndANoteSaysSo) {
  const MeshData mesh = read_text("a.mesh", file_of(kCells));
  EXPECT_EQ(mesh.cells.size(), 2U);
  EXPECT_TRUE(mentions(mesh.notes, "no End"));
}

TEST(Medit, ReferencesThatAreAllZeroAreNone) {
  const MeshData mesh =
      read_text("a.mesh", std::string(kHead) + "Vertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n" +
                              "Tetrahedra 1\n1 2 3 4 0\nEnd\n");
  EXPECT_TRUE(mesh.regions.empty());
  EXPECT_TRUE(mesh.vertex_labels.empty());
}

TEST(Medit, RequiredThingsAndCornersBecomeFixedVertices) {
  const MeshData mesh = read_text(
      "a.mesh",
      file_of("RequiredTriangles 1\n2\nTriangles 2\n1 2 3 5\n2 3 4 6\nEdges 1\n4 5 8\nRequiredVertices 1\n2\n"
              "Corners 1\n1\nRequiredEdges 1\n1\nEnd\n"));
  EXPECT_THAT(mesh.fixed_vertices, ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(mesh.triangle_labels, ElementsAre(5, 6));
  EXPECT_THAT(mesh.edge_labels, ElementsAre(8));
  EXPECT_TRUE(mentions(mesh.notes, "Corners (1)"));
  EXPECT_TRUE(mentions(mesh.notes, "RequiredEdges (1)"));
  EXPECT_TRUE(mentions(mesh.notes, "RequiredTriangles (1)"));
}

TEST(Medit, OtherSectionsAreSkippedWithOneNoteEach) {
  const MeshData mesh = read_text(
      "a.mesh",
      file_of("Ridges 2\n1\n2\nNormals 1\n0 0 1\nAngleOfCornerBound 30\nQuadrilaterals 1\n1 2 3 4 1\n") +
          "Hexahedra 0\n" + kCells + "End\n");
  EXPECT_EQ(mesh.cells.size(), 2U);
  EXPECT_THAT(mesh.notes,
              ElementsAre("Ridges (2) is not kept", "Normals (1) is not kept",
                          "AngleOfCornerBound (30) is not kept", "Quadrilaterals (1) is not kept"));
}

TEST(Medit, OtherCellsAreRefusedByName) {
  const TemporaryFolder folder;
  EXPECT_EQ(message_of_reading(folder, "a.mesh", file_of("Hexahedra 1\n1 2 3 4 5 1 2 3 0\nEnd\n")),
            "a.mesh:10: 1 Hexahedra: only tetrahedra of first and second order are read");
  EXPECT_NE(message_of_reading(folder, "a.mesh", file_of("TetrahedraP3 1\n1 2 3 4 5 0\nEnd\n"))
                .find("TetrahedraP3"),
            std::string::npos);
}

TEST(Medit, SecondOrderElementsAreMadeLinearAndTheirEdgePointsLeaveWithAllTheyHad) {
  const TemporaryFolder folder;
  samples::write_bytes(
      folder / "a.sol",
      "MeshVersionFormatted 2 Dimension 3 SolAtVertices 11 1 1 0 1 2 3 4 5 6 7 8 9 10 End\n");
  samples::write_bytes(folder / "a.mesh",
                       std::string(kHead) +
                           "Vertices 11\n9 9 9 1\n0 0 0 2\n.5 0 0 3\n1 0 0 4\n0 1 0 5\n0 0 1 6\n0 0 0 "
                           "7\n0 0 0 8\n0 0 0 9\n0 0 0 10\n0 0 0 11\n"
                           "TetrahedraP2 1\n2 4 5 6 3 7 8 9 10 11 42\nRequiredVertices 2\n6 7\nEnd\n");
  const MeshData mesh = read_mesh(folder / "a.mesh");
  EXPECT_THAT(mesh.cells, ElementsAre(std::array<Index, 4>{1, 2, 3, 4}));
  EXPECT_THAT(mesh.regions, ElementsAre(42));
  EXPECT_THAT(mesh.vertex_labels, ElementsAre(1, 2, 4, 5, 6)) << "the unused point 0 stays";
  EXPECT_THAT(mesh.fixed_vertices, ElementsAre(4));
  ASSERT_EQ(mesh.point_fields.size(), 1U);
  EXPECT_THAT(mesh.point_fields[0].values, ElementsAre(0, 1, 3, 4, 5));
  EXPECT_TRUE(mentions(mesh.notes, "1 TetrahedraP2 were made linear"));
}

TEST(Medit, BrokenTextIsRefusedWithItsLine) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) { return message_of_reading(folder, "a.mesh", text); };
  EXPECT_EQ(message(""), "a.mesh: the file is empty");
  EXPECT_EQ(message("solid x\n"), "a.mesh:1: not a Medit file: no MeshVersionFormatted");
  EXPECT_EQ(message("MFEM mesh v1.0\n\ndimension\n3\n"),
            "a.mesh:1: a mesh of MFEM's own format cannot be read: save it with Mesh::PrintVTK");
  EXPECT_EQ(message("MeshVersionFormatted 2\nDimension 2\n"),
            "a.mesh:2: dimension 2 is out of range (3 to 3)");
  EXPECT_EQ(message(file_of("Tetrahedra 1\n1 2 3 6 0\nEnd\n")),
            "a.mesh:11: vertex 6 is out of range (1 to 5)");
  EXPECT_EQ(message(file_of("Tetrahedra 1\n0 2 3 4 0\nEnd\n")),
            "a.mesh:11: vertex 0 is out of range (1 to 5)");
  EXPECT_EQ(message(std::string(kHead) + "Vertices 1\n0 nan 0 0\nEnd\n"),
            "a.mesh:5: expected a finite number, found 'nan'");
  EXPECT_EQ(message(std::string(kHead) + "Vertices 1000000000000000000\n0 0 0 0\n"),
            "a.mesh:4: Vertices announces 1000000000000000000 entries and has 1");
  EXPECT_EQ(message(std::string(kHead) + "Vertices 3\n0 0 0 0\n1 0 0 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n"),
            "a.mesh:7: Vertices announces 3 entries and has 2");
  EXPECT_EQ(message(file_of("Tetrahedra 2\n1 2 3 4 0\n")),
            "a.mesh:10: Tetrahedra announces 2 entries and has 1");
  EXPECT_EQ(message(file_of("Tetrahedra 1\n1 2 3 4 0\n1 2 3 5 0\nEnd\n")),
            "a.mesh:12: expected a keyword; the section before may have more entries than it says");
  EXPECT_EQ(message(file_of("RequiredEdges 1\n4\nEnd\n")).substr(0, 7), "a.mesh:");
  EXPECT_EQ(message(file_of("RequiredVertices 1\n9\nEnd\n")),
            "a.mesh: fixed vertex 8 is out of range (the file has 5 points)");
}

TEST(Medit, CellsBeforePointsAreCheckedAfterwards) {
  const TemporaryFolder folder;
  const std::string text = std::string(kHead) + "Tetrahedra 1\n1 2 3 99 0\n" + kPoints + "End\n";
  EXPECT_EQ(message_of_reading(folder, "a.mesh", text),
            "a.mesh: cell 0: vertex 98 is out of range (the file has 5 points)");
}

TEST(Medit, FieldsComeFromTheSolutionBesideTheMesh) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.mesh", file_of(std::string(kCells) + "End\n"));
  samples::write_bytes(
      folder / "a.sol",
      "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n5\n2 1 2\n1 10 11 12\n2 20 21 22\nnan 0 0 "
      "0\n4 0 0 0\n5 0 0 0\nSolAtTetrahedra 2 1 3\n1 2 3 4 5 6\n7 8 9 10 11 12\nEnd\n");
  const MeshData mesh = read_mesh(folder / "a.mesh");
  ASSERT_EQ(mesh.point_fields.size(), 2U);
  EXPECT_EQ(mesh.point_fields[0].name, "solution_1");
  EXPECT_EQ(mesh.point_fields[1].components, 3);
  EXPECT_EQ(mesh.point_fields[1].values[5], 22);
  ASSERT_EQ(mesh.cell_fields.size(), 1U);
  EXPECT_THAT(mesh.cell_fields[0].values, ElementsAre(1, 3, 6, 2, 5, 4, 7, 9, 12, 8, 11, 10))
      << "Medit's xx xy yy xz yz zz becomes xx yy zz xy yz xz";
}

TEST(Medit, ASolutionOfAnotherMeshIsLeftOutAndABrokenOneIsRefused) {
  const TemporaryFolder folder;
  const std::string mesh_text = file_of(std::string(kCells) + "End\n");
  samples::write_bytes(folder / "a.sol",
                       "MeshVersionFormatted 2\nDimension 3\nSolAtVertices 2 1 1 5 6 End\n");
  samples::write_bytes(folder / "a.mesh", mesh_text);
  const MeshData mesh = read_mesh(folder / "a.mesh");
  EXPECT_TRUE(mesh.point_fields.empty());
  EXPECT_THAT(mesh.notes, ElementsAre("a.sol is left out: it has values for 2 points, the mesh has 5"));
  samples::write_bytes(folder / "a.sol",
                       "MeshVersionFormatted 2\nDimension 3\nSolAtVertices 2 1 7 5 6 End\n");
  EXPECT_EQ(message_of_reading(folder, "a.mesh", mesh_text),
            "a.sol:3: a solution's type must be 1, 2, 3 or 4");
}

TEST(Medit, AStaleSolutionBesideTheOutputIsNamed) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.sol", "old");
  EXPECT_TRUE(mentions(write_mesh(folder / "a.mesh", samples::two_cells()), "a.sol"));
  samples::write_bytes(folder / "b.solb", "old");
  EXPECT_TRUE(mentions(write_mesh(folder / "b.mesh", samples::two_cells()), "b.solb"));
  samples::write_bytes(folder / "C.SOL", "old");
  EXPECT_TRUE(mentions(write_mesh(folder / "C.MESH", samples::two_cells()), "C.SOL"));
}

/// A binary file of any version and byte order, section by section.
class BinaryFile {
 public:
  BinaryFile(int version, bool swapped) : version_(version), swapped_(swapped) {
    put<std::int32_t>(1);
    put<std::int32_t>(version);
    put<std::int32_t>(3);
    position(bytes_.size() + (version < 3 ? 8 : 12));
    put<std::int32_t>(3);
  }
  BinaryFile& section(int code, std::size_t body_size) {
    put<std::int32_t>(code);
    position(bytes_.size() + (version_ < 3 ? 4U : 8U) + body_size);
    return *this;
  }
  BinaryFile& integer(std::int64_t value) {
    version_ < 4 ? put(static_cast<std::int32_t>(value)) : put(value);
    return *this;
  }
  BinaryFile& real(double value) {
    version_ == 1 ? put(static_cast<float>(value)) : put(value);
    return *this;
  }
  std::size_t integer_size() const { return version_ < 4 ? 4 : 8; }
  std::size_t real_size() const { return version_ == 1 ? 4 : 8; }
  std::string end() {
    put<std::int32_t>(54);
    position(0);
    return bytes_;
  }

 private:
  template <class T>
  void put(T value) {
    std::array<char, sizeof(T)> raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (swapped_) std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.data(), raw.size());
  }
  void position(std::size_t value) {
    version_ < 3 ? put(static_cast<std::int32_t>(value)) : put(static_cast<std::int64_t>(value));
  }

  int version_;
  bool swapped_;
  std::string bytes_;
};

std::string binary_mesh(int version, bool swapped) {
  BinaryFile file(version, swapped);
  const std::size_t i = file.integer_size();
  const std::size_t r = file.real_size();
  file.section(4, i + 4 * (i + 3 * r)).integer(4);
  for (int k = 0; k < 4; ++k) file.real(k == 1).real(k == 2).real(k == 3).integer(k);
  file.section(14, 2 * i).integer(1).integer(77);
  file.section(8, 6 * i).integer(1).integer(1).integer(2).integer(3).integer(4).integer(9);
  file.section(15, 2 * i).integer(1).integer(3);
  return file.end();
}

TEST(Meditb, EveryVersionAndByteOrder) {
  for (int version = 1; version <= 4; ++version) {
    for (const bool swapped : {false, true}) {
      const MeshData mesh = read_text("a.meshb", binary_mesh(version, swapped));
      SCOPED_TRACE(version);
      ASSERT_EQ(mesh.points.size(), 4U);
      EXPECT_EQ(mesh.points[2], (Vec3{0, 1, 0}));
      EXPECT_THAT(mesh.vertex_labels, ElementsAre(0, 1, 2, 3));
      EXPECT_THAT(mesh.cells, ElementsAre(std::array<Index, 4>{0, 1, 2, 3}));
      EXPECT_THAT(mesh.regions, ElementsAre(9));
      EXPECT_THAT(mesh.fixed_vertices, ElementsAre(2));
      EXPECT_THAT(mesh.notes, ElementsAre("Ridges (1) is not kept"));
    }
  }
}

TEST(Meditb, TheFirstBytesDecideAndNotTheExtension) {
  EXPECT_EQ(read_text("a.mesh", binary_mesh(2, false)).cells.size(), 1U);
  EXPECT_EQ(read_text("a.meshb", file_of(std::string(kCells) + "End\n")).cells.size(), 2U);
}

TEST(Meditb, BrokenBytesAreRefusedWithTheirPlace) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& bytes) { return message_of_reading(folder, "a.meshb", bytes); };
  const std::string good = binary_mesh(2, false);
  EXPECT_EQ(message(good), "ok");
  EXPECT_EQ(message(good.substr(0, 60)).substr(0, 12), "a.meshb: at ");
  const auto patched = [&](std::size_t at, const std::string& with) {
    return std::string(good).replace(at, with.size(), with);
  };
  EXPECT_EQ(message(patched(4, std::string("\x09\0\0\0", 4))),
            "a.meshb: at byte 8: version 9 is not known (1 to 4 are)");
  EXPECT_EQ(message(patched(16, std::string("\x02\0\0\0", 4))),
            "a.meshb: at byte 20: dimension 2: only 3 is read");
  EXPECT_EQ(message(patched(24, std::string("\x05\0\0\0", 4))),
            "a.meshb: at byte 28: the position of the next section, 5, is outside the file");
  EXPECT_EQ(message(patched(28, "\xff\xff\xff\x7f")),
            "a.meshb: at byte 32: Vertices announces 2147483647 entries and has 4");
  EXPECT_EQ(message(patched(32 + 4, "\xff\xff\xff\xff")), "a.meshb: at byte 40: a coordinate is not finite");
}

TEST(Medit, RealMeshesHaveTheirCounts) {
  const struct {
    const char* name;
    std::size_t points, cells, triangles;
  } kMeshes[] = {{"gaia_dog/dog.mesh", 28390, 94367, 50582},
                 {"gaia_frog_reg/frog_reg.mesh", 6834, 21909, 13038},
                 {"random50k/random50k.mesh", 9261, 53995, 4800},
                 {"tangled/bad2.mesh", 343, 1296, 504},
                 {"cavity/cavity20k.mesh", 4080, 20160, 0}};
  for (const auto& expected : kMeshes) {
    const std::filesystem::path path = std::filesystem::path(HFR_TEST_MESHES) / expected.name;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    const MeshData mesh = read_mesh(path);
    EXPECT_EQ(mesh.points.size(), expected.points) << path;
    EXPECT_EQ(mesh.cells.size(), expected.cells) << path;
    EXPECT_EQ(mesh.triangles.size(), expected.triangles) << path;
  }
}

}  // namespace
}  // namespace hfr::io
