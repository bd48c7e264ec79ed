// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstring>

#include "IO/VtkSamples.hh"

namespace hfr::io {
namespace {

using samples::expect_same;
using samples::has_note;
using samples::replaced;
using samples::TemporaryFolder;

struct Variant {
  const char* name;
  WriteOptions options;
};

class VtkVariants : public testing::TestWithParam<Variant> {};

INSTANTIATE_TEST_SUITE_P(All, VtkVariants,
                         testing::Values(Variant{"Ascii42", {false, ""}}, Variant{"Binary42", {true, "4.2"}},
                                         Variant{"Ascii51", {false, "5.1"}},
                                         Variant{"Binary51", {true, "5.1"}}),
                         [](const auto& test) { return test.param.name; });

TEST_P(VtkVariants, EverythingAMeshHoldsComesBackBitForBit) {
  const TemporaryFolder folder;
  const MeshData mesh = samples::full();
  EXPECT_EQ(write_mesh(folder / "a.vtk", mesh, GetParam().options), std::vector<std::string>{});
  const MeshData read = read_mesh(folder / "a.vtk");
  expect_same(read, mesh);
  EXPECT_TRUE(read.notes.empty()) << read.notes[0];
}

TEST_P(VtkVariants, RandomBitPatternsComeBack) {
  const TemporaryFolder folder;
  const MeshData mesh = samples::random_bits(500, 1);
  write_mesh(folder / "a.vtk", mesh, GetParam().options);
  expect_same(read_mesh(folder / "a.vtk"), mesh);
}

TEST_P(VtkVariants, FieldsWithNamesOfLabelsStayFields) {
  const TemporaryFolder folder;
  MeshData mesh = samples::two_cells();
  mesh.cell_fields = {{"Material", 1, false, {3, 4}}, {"cell_tags", 1, false, {0, 2}}};
  mesh.point_fields = {{"labels", 1, false, {1, 2, 3, 4, 5}}, {"Fixed", 1, false, {0, 1, 0, 1, 1}}};
  EXPECT_EQ(write_mesh(folder / "a.vtk", mesh, GetParam().options), std::vector<std::string>{});
  expect_same(read_mesh(folder / "a.vtk"), mesh);
}

TEST_P(VtkVariants, FieldsWithNamesOfKeywordsComeBack) {
  const TemporaryFolder folder;
  MeshData mesh = samples::two_cells();
  for (const char* name : {"METADATA", "metadata", "NULL_ARRAY", "CELL_DATA", "LOOKUP_TABLE"})
    mesh.cell_fields.push_back({name, 1, false, {0.5, 4}});
  EXPECT_EQ(write_mesh(folder / "a.vtk", mesh, GetParam().options), std::vector<std::string>{});
  expect_same(read_mesh(folder / "a.vtk"), mesh);
}

TEST_P(VtkVariants, AFieldOfTheNameOfTheArrayOfLabelsIsNoted) {
  const TemporaryFolder folder;
  MeshData mesh = samples::two_cells();
  mesh.cell_fields = {{"region", 1, false, {1, 2}}};
  mesh.point_fields = {{"fixed", 1, false, {0, 1, 0, 1, 1}}};
  EXPECT_EQ(write_mesh(folder / "a.vtk", mesh, GetParam().options),
            (std::vector<std::string>{
                "cell field 'region' is written under a name that is read as labels",
                "point field 'fixed' is written under a name that is read as fixed vertices"}));
  EXPECT_EQ(read_mesh(folder / "a.vtk").regions, (std::vector<int>{1, 2}));
}

TEST_P(VtkVariants, AMeshOfNothingButCellsComesBack) {
  const TemporaryFolder folder;
  MeshData mesh = samples::two_cells();
  std::swap(mesh.cells[1][0], mesh.cells[1][1]);  // of the other orientation: it must stay so
  write_mesh(folder / "a.vtk", mesh, GetParam().options);
  expect_same(read_mesh(folder / "a.vtk"), mesh);
}

TEST_P(VtkVariants, AFileCutAnywhereIsRefusedOrLosesOnlyWhatFollows) {
  const TemporaryFolder folder;
  const MeshData mesh = samples::full();
  write_mesh(folder / "a.vtk", mesh, GetParam().options);
  const std::string bytes = samples::read_bytes(folder / "a.vtk");
  std::size_t n_refused = 0;
  for (std::size_t length = 1; length < bytes.size(); ++length) {
    samples::write_bytes(folder / "cut.vtk", bytes.substr(0, length));
    try {
      const MeshData read = read_mesh(folder / "cut.vtk");
      EXPECT_TRUE(samples::same_bits(read.points, mesh.points)) << length;
      EXPECT_EQ(read.cells, mesh.cells) << length;
    } catch (const InvalidInput& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with((folder / "cut.vtk").string() + ":")) << error.what();
      ++n_refused;
    }
  }
  EXPECT_GT(n_refused, bytes.size() * 8 / 10);
}

TEST_P(VtkVariants, AByteChangedNeverDoesMoreThanThrow) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.vtk", samples::full(), GetParam().options);
  const std::string bytes = samples::read_bytes(folder / "a.vtk");
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const char value : {'9', '\xff'}) {
      std::string broken = bytes;
      broken[at] = value;
      static_cast<void>(samples::message_for(folder / "b.vtk", broken));
    }
  }
}

constexpr const char* kTwoCells =
    "# vtk DataFile Version 2.0\n"
    "two cells\n"
    "ASCII\n"
    "DATASET UNSTRUCTURED_GRID\n"
    "POINTS 5 double\n"
    "0 0 0  1 0 0  0 1 0  0 0 1  1 1 1\n"
    "CELLS 3 14\n"
    "4 0 1 2 3\n"
    "4 1 2 3 4\n"
    "3 0 1 2\n"
    "CELL_TYPES 3\n"
    "10 10 5\n";

MeshData read_text(const TemporaryFolder& folder, const std::string& text) {
  samples::write_bytes(folder / "a.vtk", text);
  return read_mesh(folder / "a.vtk");
}

TEST(Vtk, AttributesOfEveryKindAreReadOrPassedOver) {
  const TemporaryFolder folder;
  const MeshData mesh = read_text(
      folder, std::string(kTwoCells) +
                  "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n"
                  "CELL_DATA 3\n"
                  "SCALARS density float\nLOOKUP_TABLE default\n1.5 2.5 0\n"
                  "SCALARS MaterialIDs int 1\nLOOKUP_TABLE mine\n7 8 9\n"
                  "LOOKUP_TABLE mine 2\n0 0 0 1  1 1 1 1\n"
                  "METADATA\nCOMPONENT_NAMES\nx\n\n"
                  "TENSORS stress float\n1 2 3 4 5 6 7 8 9  1 2 3 4 5 6 7 8 9  0 0 0 0 0 0 0 0 0\n"
                  "FIELD FieldData 2\n"
                  "my%20field 2 3 double\n1 2 3 4 nan 6\n"
                  "METADATA\nINFORMATION 0\n\n"
                  "comment 1 3 string\none\n\nthree\n"
                  "POINT_DATA 5\n"
                  "VECTORS velocity double\n1 2 3 4 5 6 7 8 9 10 11 12 13 14 15\n"
                  "NORMALS n float\n1 0 0 1 0 0 1 0 0 1 0 0 1 0 0\n"
                  "TEXTURE_COORDINATES uv 2 float\n0 0 1 1 2 2 3 3 4 4\n"
                  "COLOR_SCALARS paint 3\n0 0 0 1 1 1 .5 .5 .5 1 0 0 0 1 0\n"
                  "GLOBAL_IDS ids vtkIdType\n10 11 12 13 14\n"
                  "SCALARS label unsigned_char 1\n0 1 2 3 4\n");
  EXPECT_EQ(mesh.regions, (std::vector<int>{7, 8}));
  EXPECT_EQ(mesh.triangle_labels, (std::vector<int>{9}));
  EXPECT_EQ(mesh.vertex_labels, (std::vector<int>{0, 1, 2, 3, 4}));
  ASSERT_EQ(mesh.cell_fields.size(), 3u);
  EXPECT_EQ(mesh.cell_fields[0].values, (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(mesh.cell_fields[1].components, 9);
  EXPECT_EQ(mesh.cell_fields[2].name, "my field");
  EXPECT_EQ(mesh.cell_fields[2].values, (std::vector<double>{1, 2, 3, 4}));
  ASSERT_EQ(mesh.point_fields.size(), 4u);
  EXPECT_EQ(mesh.point_fields[0].components, 3);
  EXPECT_EQ(mesh.point_fields[2].values[9], 4);
  EXPECT_TRUE(mesh.point_fields[3].integer);
  EXPECT_TRUE(has_note(mesh, "strings 'comment' dropped"));
  EXPECT_TRUE(has_note(mesh, "colours 'paint' dropped"));
  EXPECT_TRUE(has_note(mesh, "cell field 'my field': only its values on tetrahedra"));
  EXPECT_FALSE(has_note(mesh, "density")) << "nothing is lost of a field that is 0 on the triangles";
}

TEST(Vtk, FixedVerticesMayBeGivenAsRealNumbers) {
  const TemporaryFolder folder;
  for (const char* type : {"float", "double", "int", "unsigned_char"}) {
    const MeshData mesh = read_text(folder, std::string(kTwoCells) + "POINT_DATA 5\nSCALARS fixed " + type +
                                                "\nLOOKUP_TABLE default\n1 0 0 1 0\n");
    EXPECT_EQ(mesh.fixed_vertices, (std::vector<Index>{0, 3})) << type;
    EXPECT_TRUE(mesh.point_fields.empty()) << type;
  }
  const MeshData odd =
      read_text(folder, std::string(kTwoCells) +
                            "POINT_DATA 5\nSCALARS fixed float\nLOOKUP_TABLE default\n1 0 .5 1 0\n");
  EXPECT_TRUE(odd.fixed_vertices.empty());
  EXPECT_TRUE(has_note(odd, "'fixed' has other values than 0 and 1"));
  ASSERT_EQ(odd.point_fields.size(), 1u);
}

TEST(Vtk, IntegersThatNoLabelCanHoldAreRefused) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& rest) {
    return samples::short_message_for(folder / "a.vtk", std::string(kTwoCells) + rest);
  };
  EXPECT_EQ(
      message("CELL_DATA 3\nSCALARS region long\nLOOKUP_TABLE default\n1 3000000000 0\n"),
      ": cell array 'region': 3000000000 of cell 1 is no label, as labels go from -2147483648 to 2147483647");
  EXPECT_EQ(message("POINT_DATA 5\nSCALARS label unsigned_int\nLOOKUP_TABLE default\n0 0 0 0 4294967295\n"),
            ": point array 'label': 4294967295 of point 4 is no label, as labels go from -2147483648 to "
            "2147483647");
  EXPECT_EQ(message("CELL_DATA 3\nSCALARS region long\nLOOKUP_TABLE default\n1 -2147483648 2147483647\n"),
            "");
}

TEST(Vtk, LabelsThatAreNoIntegersStayAField) {
  const TemporaryFolder folder;
  const MeshData mesh = read_text(folder, std::string(kTwoCells) +
                                              "CELL_DATA 3\nSCALARS region float\n1 2.5 0\n"
                                              "SCALARS Material double\n3 4 5\n");
  EXPECT_EQ(mesh.regions, (std::vector<int>{3, 4}));
  ASSERT_EQ(mesh.cell_fields.size(), 1u);
  EXPECT_EQ(mesh.cell_fields[0].name, "region");
}

TEST(Vtk, LineEndsOfWindowsAreTolerated) {
  const TemporaryFolder folder;
  std::string text;
  for (const char c :
       std::string(kTwoCells) + "CELL_DATA 3\nSCALARS region int 1\nLOOKUP_TABLE default\n1 2 3\n")
    text += c == '\n' ? "\r\n" : std::string(1, c);
  const MeshData mesh = read_text(folder, text);
  EXPECT_EQ(mesh.cells, samples::two_cells().cells);
  EXPECT_EQ(mesh.regions, (std::vector<int>{1, 2}));
}

TEST(Vtk, SecondOrderCellsAreMadeLinearAndTheirMiddleNodesDropped) {
  const TemporaryFolder folder;
  std::string text = "# vtk DataFile Version 3.0\nq\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 float\n";
  for (int i = 0; i < 12; ++i) text += std::to_string(i) + " 0.5 " + std::to_string(i * i) + "\n";
  // Point 11 belongs to nothing, point 4 is a middle node that is a corner of the line too.
  text +=
      "CELLS 4 26\n10 0 1 2 3 4 5 6 7 8 9\n6 0 1 2 4 5 6\n3 0 4 10\n3 1 2 3\nCELL_TYPES 4\n24 22 21 5\n"
      "POINT_DATA 12\nSCALARS id int 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11\n";
  const MeshData mesh = read_text(folder, text);
  EXPECT_EQ(mesh.cells, (std::vector<std::array<Index, 4>>{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<Index, 3>>{{0, 1, 2}, {1, 2, 3}}));
  EXPECT_EQ(mesh.edges, (std::vector<std::array<Index, 2>>{{0, 4}}));
  ASSERT_EQ(mesh.points.size(), 6u);
  EXPECT_EQ(mesh.points[5].x, 11);
  EXPECT_EQ(mesh.point_fields[0].values, (std::vector<double>{0, 1, 2, 3, 4, 11}));
  EXPECT_TRUE(has_note(mesh, "3 curved cells linearised, 6 middle nodes dropped"));
}

TEST(Vtk, FlatCellsThatAreNoTrianglesAreDroppedAndVerticesLabelPoints) {
  const TemporaryFolder folder;
  const MeshData mesh = read_text(folder,
                                  "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                                  "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
                                  "CELLS 5 21\n4 0 1 2 3\n4 0 1 2 3\n3 0 1 2\n1 2\n4 3 2 1 0\n"
                                  "CELL_TYPES 5\n9 10 2 1 9\nCELL_DATA 5\nSCALARS region int 1\n1 2 3 4 5\n");
  EXPECT_EQ(mesh.cells.size(), 1u);
  EXPECT_EQ(mesh.regions, (std::vector<int>{2}));
  EXPECT_EQ(mesh.vertex_labels, (std::vector<int>{0, 0, 4, 0}));
  EXPECT_TRUE(has_note(mesh, "2 cells of type VTK_QUAD dropped"));
  EXPECT_TRUE(has_note(mesh, "1 cell of type VTK_POLY_VERTEX dropped"));
}

TEST(Vtk, LabelsOfPointsAndOfCellsOfOnePointAreBothTaken) {
  const TemporaryFolder folder;
  const std::string head =
      "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n"
      "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
      "CELLS 3 9\n4 0 1 2 3\n1 2\n1 3\n"
      "CELL_TYPES 3\n10 1 1\nCELL_DATA 3\nSCALARS region int 1\nLOOKUP_TABLE default\n2 4 5\n"
      "POINT_DATA 4\nSCALARS label int 1\nLOOKUP_TABLE default\n";
  const MeshData mesh = read_text(folder, head + "7 0 0 6\n");
  EXPECT_EQ(mesh.vertex_labels, (std::vector<int>{7, 0, 4, 6}));
  EXPECT_TRUE(has_note(mesh, "1 points have one label in point array 'label' and another as a cell"));
  EXPECT_EQ(read_text(folder, head + "0 0 0 0\n").vertex_labels, (std::vector<int>{0, 0, 4, 5}));
}

TEST(Vtk, WhatIsBrokenIsNamedWithItsLine) {
  const TemporaryFolder folder;
  const std::string good = kTwoCells;
  const auto message = [&](const std::string& text) {
    return samples::short_message_for(folder / "a.vtk", text);
  };
  EXPECT_EQ(message(good), "");
  EXPECT_EQ(message(replaced(good, "10 10 5", "10 12 5")),
            ":9: cell 1: cells of type VTK_HEXAHEDRON are not supported: only tetrahedra are");
  EXPECT_EQ(message(replaced(good, "10 10 5", "10 99 5")), ":9: cell 1: unknown VTK cell type 99");
  EXPECT_EQ(message(replaced(good, "10 10 5", "10\n10\n300\n")), ":14: unknown VTK cell type 300");
  EXPECT_EQ(message(replaced(good, "10 10 5", "10 -1 5")), ":12: unknown VTK cell type -1");
  EXPECT_EQ(message(replaced(good, "CELL_TYPES 3", "CELL_TYPES 2")), ":11: 2 cell types for 3 cells");
  EXPECT_EQ(message(replaced(good, "10 10 5", "10 5 5")),
            ":9: cell 1: a cell of type VTK_TRIANGLE has 4 nodes");
  EXPECT_EQ(message(replaced(good, "4 1 2 3 4", "4 1 2 3 5")),
            ":9: cell 1: vertex 5 is out of range (the file has 5 points, counted from 0)");
  EXPECT_EQ(message(replaced(good, "4 1 2 3 4", "4 1 2 -3 4")),
            ":9: cell 1: vertex -3 is out of range (the file has 5 points, counted from 0)");
  EXPECT_EQ(message(replaced(good, "0 0 1  1 1 1", "0 nan 1  1 1 1")),
            ":6: expected a finite number, found 'nan'");
  EXPECT_EQ(message(replaced(good, "UNSTRUCTURED_GRID", "POLYDATA")),
            ":4: DATASET 'POLYDATA' is not supported: only UNSTRUCTURED_GRID is");
  EXPECT_EQ(message(replaced(good, "POINTS 5 double", "POINTS 5000000000 double")),
            ":5: 5000000000 points are more than the rest of the file can hold");
  EXPECT_EQ(message(replaced(good, "CELLS 3 14", "CELLS 3 13")),
            ":10: cell 2: 3 corners do not fit into the cell list");
  EXPECT_EQ(message(replaced(good, "POINTS 5 double", "POINTS 5 doubt")), ":5: unknown data type 'doubt'");
  EXPECT_EQ(message(good + "CELL_DATA 4\n"), ":13: CELL_DATA has 4 entries for 3 cells");
  EXPECT_EQ(message(good + "NONSENSE 4\n"), ":13: unknown keyword 'nonsense'");
  EXPECT_EQ(message(replaced(good, "# vtk", "# atk")).substr(0, 31), ":1: this is no legacy VTK file:");
  EXPECT_EQ(message("<VTKFile type=\"UnstructuredGrid\">\n"), ":1: this is a VTK XML file: name it .vtu");
  EXPECT_EQ(message("<?xml version=\"1.0\"?>\n"), ":1: this is a VTK XML file: name it .vtu");
  EXPECT_EQ(message(good.substr(0, good.find("CELL_TYPES"))),
            ":11: the file ends too early: there are no CELL_TYPES");
}

TEST(Vtk, BinaryFilesNameTheByte) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.vtk", samples::two_cells(), {true, ""});
  std::string bytes = samples::read_bytes(folder / "a.vtk");
  const std::size_t points = bytes.find(" double\n") + 8;
  bytes[points + 24] = '\x7f';  // the first byte of x of point 1: 1.0 becomes infinite
  bytes[points + 25] = '\xf0';
  EXPECT_EQ(samples::short_message_for(folder / "a.vtk", bytes),
            ": at byte " + std::to_string(points + 24) + ": point 1: a coordinate is not finite");
}

TEST(Vtk, OffsetsThatDoNotRiseToTheEndAreRefused) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.vtk", samples::two_cells(), {false, "5.1"});
  const std::string good = samples::read_bytes(folder / "a.vtk");
  const auto message = [&](const std::string& to) {
    return samples::short_message_for(folder / "b.vtk", replaced(good, "0\n4\n8\n", to));
  };
  EXPECT_NE(message("0\n9\n8\n").find("offset 1 of the cells is 9"), std::string::npos);
  EXPECT_NE(message("0\n4\n3\n").find("offset 2 of the cells is 3"), std::string::npos);
  EXPECT_NE(message("1\n4\n8\n").find("offset 0 of the cells is 1"), std::string::npos);
  EXPECT_NE(message("0\n4\n7\n").find("the last offset of the cells is 7"), std::string::npos);
  EXPECT_NE(message("0\n4\n-8\n").find("offset 2 of the cells is -8"), std::string::npos);
}

TEST(Vtk, IntegersBeyond32BitsKeepTheirValue) {
  const TemporaryFolder folder;
  MeshData mesh = samples::two_cells();
  mesh.cell_fields = {{"big", 1, true, {5e9, -5e9}}};
  write_mesh(folder / "a.vtk", mesh, {true, "5.1"});
  expect_same(read_mesh(folder / "a.vtk"), mesh);
  EXPECT_EQ(write_mesh(folder / "a.vtk", mesh).size(), 1u) << "4.2 has no integers that wide";
  EXPECT_EQ(read_mesh(folder / "a.vtk").cell_fields[0].values, mesh.cell_fields[0].values);
}

TEST(Vtk, AnUnknownVariantIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_mesh(folder / "a.vtk", samples::two_cells(), {false, "6.0"}), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.vtk"));
}

TEST(Vtk, ARealMeshSurvivesEveryVariant) {
  const std::filesystem::path path = HFR_TEST_MESHES "/gaia_alligator/alligator.vtk";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const MeshData mesh = read_mesh(path);
  EXPECT_EQ(mesh.points.size(), 25966u);
  EXPECT_EQ(mesh.cells.size(), 108744u);
  const TemporaryFolder folder;
  for (const WriteOptions& options :
       {WriteOptions{false, ""}, WriteOptions{true, ""}, WriteOptions{true, "5.1"}}) {
    write_mesh(folder / "a.vtk", mesh, options);
    expect_same(read_mesh(folder / "a.vtk"), mesh);
  }
}

/// A number as binary legacy files have it: the highest byte first.
template <class T>
std::string big_endian(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::little) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
  }
  return bytes;
}

std::string binary_cell() {
  return "# vtk DataFile Version 4.2\nq\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n" +
         big_endian<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) + "\nCELLS 1 5\n" +
         big_endian<std::int32_t>({4, 0, 1, 2, 3}) + "\nCELL_TYPES 1\n" + big_endian<std::int32_t>({10}) +
         "\nPOINT_DATA 4\n";
}

template <class T>
std::string binary_array(const std::string& type) {
  return "a_" + type + " 1 4 " + type + "\n" + big_endian<T>({0, 1, 2, 100}) + "\n";
}

TEST(Vtk, BinaryArraysOfEveryTypeAreRead) {
  const TemporaryFolder folder;
  const MeshData mesh = read_text(
      folder, binary_cell() + "FIELD FieldData 10\n" + binary_array<std::int8_t>("char") +
                  binary_array<std::uint8_t>("unsigned_char") + binary_array<std::int16_t>("short") +
                  binary_array<std::uint16_t>("unsigned_short") + binary_array<std::int32_t>("int") +
                  binary_array<std::uint32_t>("unsigned_int") + binary_array<std::int64_t>("vtktypeint64") +
                  binary_array<float>("float") + binary_array<double>("double") + "flags 1 4 bit\n\xb0\n");
  ASSERT_EQ(mesh.point_fields.size(), 10U);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_EQ(mesh.point_fields[i].values, (std::vector<double>{0, 1, 2, 100})) << mesh.point_fields[i].name;
  EXPECT_EQ(mesh.point_fields[9].values, (std::vector<double>{1, 0, 1, 1}))
      << "a bit each, the highest first";
}

TEST(Vtk, BinaryStringsAndColoursArePassedOver) {
  const TemporaryFolder folder;
  // A length of one byte begins with the bits 11, one of two bytes with 10.
  const std::string strings = "comment 1 4 string\n\xc3one\xc0\xc1x" + std::string("\x80\x03two") + "\n";
  const std::string colours = "COLOR_SCALARS paint 3\n" + std::string(12, '\x7f') + "\n";
  const std::string after = "FIELD FieldData 1\n" + binary_array<double>("double");
  const MeshData mesh = read_text(folder, binary_cell() + colours + "FIELD FieldData 1\n" + strings + after);
  ASSERT_EQ(mesh.point_fields.size(), 1U);
  EXPECT_EQ(mesh.point_fields[0].values, (std::vector<double>{0, 1, 2, 100}));
  EXPECT_TRUE(has_note(mesh, "strings 'comment' dropped"));
  const std::string begin = binary_cell() + "FIELD FieldData 1\ncomment 1 4 string\n";
  EXPECT_NE(
      samples::short_message_for(folder / "a.vtk", begin + "\xff" + "four").find("longer than the rest"),
      std::string::npos);
  EXPECT_NE(
      samples::short_message_for(folder / "a.vtk", begin + "\xc0\xc0\xc0\x80").find("expected a string"),
      std::string::npos);
}

}  // namespace
}  // namespace hfr::io
