// SPDX-License-Identifier: BSD-3-Clause
// Round trips through all variants, and what the reader makes of files that others wrote.
#include <limits>

#include "IO/GmshFiles.hh"

namespace hfr::io {
namespace {

using namespace gmsh_files;
using samples::same_bits;

/// A mesh in version 4.1 with a volume (entity 5, group 7), a surface (entity 2, no group) and a point.
const std::string kAscii41 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n2\n3 7 \"soft rubber\"\n0 9 \"tip\"\n$EndPhysicalNames\n"
    "$Entities\n1 0 1 1\n4 0 0 1 1 9\n2 0 0 0 1 1 0 0 0\n5 0 0 0 1 1 1 1 7 1 -2\n$EndEntities\n"
    "$Nodes\n2 5 10 1000000000000\n3 5 0 3\n10\n20\n1000000000000\n0 0 0\n1 0 0\n0 1 0\n"
    "0 4 0 2\n30\n15\n0 0 1\n1 1 1\n$EndNodes\n"
    "$Elements\n3 4 1 4\n0 4 15 1\n1 30\n2 2 2 1\n2 10 20 1000000000000\n"
    "3 5 4 2\n3 10 20 1000000000000 30\n4 20 1000000000000 30 15\n$EndElements\n";

class GmshRoundTrip : public testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, GmshRoundTrip, testing::ValuesIn(kVariants), variant_name);

void expect_same_fields(const std::vector<Field>& a, const std::vector<Field>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].components, b[i].components);
    EXPECT_TRUE(same_bits(a[i].values, b[i].values)) << a[i].name;
  }
}

void expect_same(const MeshData& a, const MeshData& b) {
  EXPECT_TRUE(same_bits(a.points, b.points));
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.regions, b.regions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.triangle_labels, b.triangle_labels);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.edge_labels, b.edge_labels);
  EXPECT_EQ(a.vertex_labels, b.vertex_labels);
  EXPECT_EQ(a.names, b.names);
  expect_same_fields(a.point_fields, b.point_fields);
  expect_same_fields(a.cell_fields, b.cell_fields);
}

TEST_P(GmshRoundTrip, EverythingThatTheFormatHoldsComesBack) {
  const MeshData mesh = samples::full();
  const Written file = written(mesh, GetParam());
  const MeshData back = read_file(file.bytes);
  expect_same(back, mesh);
  EXPECT_TRUE(back.notes.empty());
  EXPECT_TRUE(has_note(file.notes, "fixed"));
  EXPECT_TRUE(has_note(file.notes, "integer fields: 'rank'"));
}

TEST_P(GmshRoundTrip, RandomBitsAndInterleavedRegionsComeBackInOrder) {
  const MeshData mesh = samples::random_bits(300, 2013);
  expect_same(read_file(written(mesh, GetParam()).bytes), mesh);
}

TEST_P(GmshRoundTrip, ZeroAndNegativeLabelsComeBack) {
  MeshData mesh = samples::two_cells();
  mesh.cells.push_back({0, 2, 1, 4});
  mesh.regions = {1, 0, -1};
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}};
  mesh.triangle_labels = {0, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  mesh.vertex_labels = {-5, 0, 2, 0, 0};
  mesh.names = {{{3, 0}, "air"}, {{3, 1}, "steel"}, {{3, -1}, "void"}};
  const Written file = written(mesh, GetParam());
  expect_same(read_file(file.bytes), mesh);
  EXPECT_TRUE(has_note(file.notes, "negative label"));
}

TEST_P(GmshRoundTrip, MeshWithoutLabelsComesBackWithout) {
  MeshData mesh = samples::two_cells();
  mesh.triangles = {{0, 1, 2}};
  MeshData expected = mesh;
  expected.triangle_labels = {0};
  expect_same(read_file(written(mesh, GetParam()).bytes), expected);
}

TEST_P(GmshRoundTrip, PointsWithoutElementsAndNothingAtAllComeBack) {
  MeshData mesh = samples::two_cells();
  mesh.cells.clear();
  expect_same(read_file(written(mesh, GetParam()).bytes), mesh);
  expect_same(read_file(written(MeshData{}, GetParam()).bytes), MeshData{});
}

TEST_P(GmshRoundTrip, FieldsMayHoldNanAndInfinity) {
  MeshData mesh = samples::two_cells();
  mesh.cell_fields = {{"q", 1, false, {std::numeric_limits<double>::infinity(), -0.0}},
                      {"t", 9, false, std::vector<double>(18, 0.25)}};
  mesh.point_fields = {{"u", 1, false, {1, 2, 3, 4, std::numeric_limits<double>::quiet_NaN()}}};
  const MeshData back = read_file(written(mesh, GetParam()).bytes);
  expect_same_fields(back.cell_fields, mesh.cell_fields);
  EXPECT_TRUE(back.point_fields.at(0).values.at(4) != back.point_fields.at(0).values.at(4));
}

TEST_P(GmshRoundTrip, InvertedCellsKeepTheirOrder) {
  MeshData mesh = samples::two_cells();
  mesh.cells = {{0, 2, 1, 3}, {1, 2, 3, 4}};
  EXPECT_EQ(read_file(written(mesh, GetParam()).bytes).cells, mesh.cells);
}

TEST(GmshWriter, VariantThatDoesNotExistIsRefused) {
  const samples::TemporaryFolder folder;
  EXPECT_THROW(write_gmsh(folder / "mesh.msh", samples::two_cells(), {.binary = false, .variant = "3.0"}),
               InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(folder / "mesh.msh"));
}

TEST(GmshWriter, DefaultIsAsciiOfVersion41) {
  EXPECT_TRUE(written(samples::two_cells(), {"", false}).bytes.starts_with("$MeshFormat\n4.1 0 8\n"));
}

TEST(GmshWriter, NamesThatGmshCannotReadAreMended) {
  MeshData mesh = samples::two_cells();
  mesh.regions = {1, 2};
  mesh.names = {{{3, 1}, "so-called \"steel\"\n"}, {{3, 2}, std::string(126, 'n') + "\u00e9"}};
  const Written file = written(mesh, {"4.1", false});
  const MeshData back = read_file(file.bytes);
  EXPECT_EQ(back.names.at({3, 1}), "so-called 'steel' ");
  EXPECT_EQ(back.names.at({3, 2}), std::string(126, 'n'));
  EXPECT_EQ(
      std::count_if(file.notes.begin(), file.notes.end(),
                    [](const std::string& note) { return note.find("127 bytes") != std::string::npos; }),
      2);
}

TEST(GmshWriter, NameOfLabelZeroStandsLast) {
  MeshData mesh = samples::two_cells();
  mesh.regions = {0, 1};
  mesh.names = {{{3, 0}, "air"}, {{3, 1}, "steel"}};
  const std::string bytes = written(mesh, {"4.1", false}).bytes;
  EXPECT_LT(bytes.find("steel"), bytes.find("air"));
}

TEST(GmshWriter, FieldsOfOddWidthAreNotedAndTooWideOnesLeftOut) {
  MeshData mesh = samples::two_cells();
  mesh.cell_fields = {{"six", 6, false, std::vector<double>(12, 1.5)},
                      {"ten", 10, false, std::vector<double>(20)}};
  const Written file = written(mesh, {"4.1", true});
  EXPECT_TRUE(has_note(file.notes, "'six'"));
  EXPECT_TRUE(has_note(file.notes, "'ten' is left out"));
  EXPECT_EQ(read_file(file.bytes).cell_fields.size(), 1U);
}

TEST(GmshReader, ScatteredTagsNamesAndGroupsAreUnderstood) {
  const MeshData mesh = read_file(kAscii41);
  ASSERT_EQ(mesh.points.size(), 5U);
  EXPECT_EQ(mesh.points[4], (Vec3{1, 1, 1}));
  EXPECT_EQ(mesh.cells, (std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
  EXPECT_EQ(mesh.regions, (std::vector<int>{7, 7}));
  EXPECT_EQ(mesh.triangle_labels, (std::vector<int>{0}));
  EXPECT_EQ(mesh.vertex_labels, (std::vector<int>{0, 0, 0, 9, 0}));
  EXPECT_EQ(mesh.names.at({3, 7}), "soft rubber");
}

TEST(GmshReader, DosLineEndsMakeNoDifference) {
  std::string text;
  for (const char c : kAscii41) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_same(read_file(text), read_file(kAscii41));
}

TEST(GmshReader, EntitiesAreLabelsWhereTheFileHasNoGroups) {
  const std::string text =
      replaced(replaced(kAscii41, "1 1 1 1 7 1 -2", "1 1 1 0 1 -2"), "0 0 1 1 9", "0 0 1 0");
  const MeshData mesh = read_file(text);
  EXPECT_EQ(mesh.regions, (std::vector<int>{5, 5}));
  EXPECT_EQ(mesh.triangle_labels, (std::vector<int>{2}));
  EXPECT_EQ(mesh.vertex_labels, (std::vector<int>{0, 0, 0, 4, 0}));
}

TEST(GmshReader, FirstOfSeveralGroupsIsTakenAndNoted) {
  const MeshData mesh = read_file(replaced(kAscii41, "1 1 1 1 7 1 -2", "1 1 1 3 -8 7 6 1 -2"));
  EXPECT_EQ(mesh.regions, (std::vector<int>{-8, -8}));
  EXPECT_TRUE(has_note(mesh.notes, "1 entity is in several physical groups"));
}

TEST(GmshReader, FileWithoutEntitiesSectionIsRead) {
  const std::size_t begin = kAscii41.find("$Entities");
  const std::size_t end = kAscii41.find("$Nodes");
  const MeshData mesh = read_file(kAscii41.substr(0, begin) + kAscii41.substr(end));
  EXPECT_EQ(mesh.regions, (std::vector<int>{5, 5}));
}

TEST(GmshReader, UnknownSectionsAreSkippedAndLinksNoted) {
  const MeshData mesh = read_file("$Comments\n$Nodes are not here\n$EndComments\n" + kAscii41 +
                                  "$Surface\n1 2 3\n$EndSurfaces\n$EndSurface\n$Periodic\n0\n$EndPeriodic\n"
                                  "$ElementNodeData\n1\n$EndElementNodeData\n");
  EXPECT_EQ(mesh.cells.size(), 2U);
  ASSERT_EQ(mesh.notes.size(), 2U);
  EXPECT_TRUE(has_note(mesh.notes, "$Periodic"));
  EXPECT_TRUE(has_note(mesh.notes, "$ElementNodeData"));
}

TEST(GmshReader, ParametersOfNodesAreSkipped) {
  const std::string text =
      replaced(replaced(kAscii41, "3 5 0 3\n", "3 5 1 3\n"), "0 0 0\n1 0 0\n0 1 0\n0 4 0 2",
               "0 0 0 .1 .2 .3\n1 0 0 .4 .5 .6\n0 1 0 .7 .8 .9\n0 4 1 2");
  expect_same(read_file(text), read_file(kAscii41));
}

TEST(GmshReader, QuadranglesAreLeftOutWithANote) {
  const std::string text =
      replaced(kAscii41, "2 2 2 1\n2 10 20 1000000000000\n", "2 2 3 1\n2 10 20 1000000000000 30\n");
  const MeshData mesh = read_file(text);
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_TRUE(has_note(mesh.notes, "1 quadrangle left out"));
}

TEST(GmshReader, PartsOfAPartitionedEntityAreThatEntity) {
  const std::string text = replaced(
      replaced(replaced(replaced(kAscii41, "1 1 1 1 7 1 -2", "1 1 1 0 1 -2"), "0 0 1 1 9", "0 0 1 0"),
               "$EndEntities\n",
               "$EndEntities\n$PartitionedEntities\n2\n1\n8 1\n1 0 0 1\n"
               "6 0 4 1 1 0 0 1 0\n9 3 5 2 1 2 0 0 0 1 1 1 0 0\n$EndPartitionedEntities\n"),
      "3 5 4 2\n", "3 9 4 2\n");
  EXPECT_EQ(read_file(text).regions, (std::vector<int>{5, 5}));
}

TEST(GmshReader, SecondOrderElementsBecomeLinearAndLoseTheirMidsideNodes) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n12\n";
  for (int i = 0; i < 12; ++i) text += std::to_string(i) + " " + std::to_string(i) + " 0 0.5\n";  // 0-based
  text +=
      "$EndNodes\n$Elements\n4\n1 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n2 9 2 2 1 1 2 3 5 6 7\n"
      "3 1 2 3 1 5 1\n4 8 2 4 1 1 2 5\n$EndElements\n$NodeData\n1\n\"x\"\n0\n3\n0\n1\n12\n";
  for (int i = 0; i < 12; ++i) text += std::to_string(i) + " " + std::to_string(i) + "\n";
  const MeshData mesh = read_file(text + "$EndNodeData\n");
  // Kept: 0 and 11, which nothing uses; the corners 1 to 4; node 5, which ends a line.
  ASSERT_EQ(mesh.points.size(), 7U);
  EXPECT_EQ(mesh.points[6].x, 11);
  EXPECT_EQ(mesh.cells, (std::vector<std::array<Index, 4>>{{1, 2, 3, 4}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<Index, 3>>{{1, 2, 3}}));
  EXPECT_EQ(mesh.edges, (std::vector<std::array<Index, 2>>{{5, 1}, {1, 2}}));
  EXPECT_EQ(mesh.point_fields.at(0).values, (std::vector<double>{0, 1, 2, 3, 4, 5, 11}));
  EXPECT_TRUE(has_note(mesh.notes, "3 elements of higher order made linear, 5 nodes of them dropped"));
}

TEST(GmshReader, ElementsThatVersion2RepeatsForEachGroupAreTakenOnce) {
  const MeshData mesh = read_file(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 "
      "1\n$EndNodes\n"
      "$Elements\n5\n1 4 2 10 1 1 2 3 4\n2 4 2 20 2 2 3 4 5\n3 4 2 30 1 1 2 3 4\n4 4 2 30 2 2 3 4 5\n"
      "5 2 4 10 1 1 1 1 2 3\n$EndElements\n");
  EXPECT_EQ(mesh.cells.size(), 2U);
  EXPECT_EQ(mesh.regions, (std::vector<int>{10, 20}));
  EXPECT_EQ(mesh.triangle_labels, (std::vector<int>{10}));
  EXPECT_TRUE(has_note(mesh.notes, "several physical groups"));
}

TEST(GmshReader, LastTimeStepOfAFieldIsTakenAndGapsAreNoted) {
  const auto data = [](const std::string& section, const std::string& step, const std::string& rows) {
    return "$" + section + "\n2\n\"u v\"\n\"scheme\"\n1\n0.5\n4\n" + step + rows + "$End" + section + "\n";
  };
  const MeshData mesh =
      read_file(kAscii41 + data("NodeData", "0\n1\n2\n0\n", "10 1\n20 2\n") +
                data("NodeData", "1\n1\n1\n0\n", "10 3\n") + data("NodeData", "1\n1\n1\n1\n", "15 4\n") +
                data("ElementData", "0\n3\n2\n0\n", "2 9 9 9\n4 1 2 3\n"));
  ASSERT_EQ(mesh.point_fields.size(), 1U);
  EXPECT_EQ(mesh.point_fields[0].name, "u v");
  EXPECT_EQ(mesh.point_fields[0].values, (std::vector<double>{3, 0, 0, 0, 4}));
  EXPECT_TRUE(has_note(mesh.notes, "several time steps"));
  EXPECT_TRUE(has_note(mesh.notes, "no value on 3 points"));
  ASSERT_EQ(mesh.cell_fields.size(), 1U);
  EXPECT_EQ(mesh.cell_fields[0].values, (std::vector<double>{0, 0, 0, 1, 2, 3}));
  EXPECT_TRUE(has_note(mesh.notes, "1 value on elements other than tetrahedra"));
}

TEST(GmshReader, FieldsWithoutAnyValueAreLeftOut) {
  const MeshData mesh = read_file(kAscii41 +
                                  "$NodeData\n1\n\"none\"\n0\n3\n0\n9\n0\n$EndNodeData\n"
                                  "$NodeData\n1\n\"u\"\n0\n3\n0\n1\n1\n10 4\n$EndNodeData\n");
  ASSERT_EQ(mesh.point_fields.size(), 1U);
  EXPECT_EQ(mesh.point_fields[0].name, "u");
  EXPECT_TRUE(has_note(mesh.notes, "field 'none' has no values and is left out"));
}

TEST(GmshReader, ParametricNodesOfVersion2AreRead) {
  const MeshData mesh = read_file(
      "$MeshFormat\n2 0 8\n$EndMeshFormat\n$ParametricNodes\n4\n1 0 0 0 0 1\n2 1 0 0 1 1 .5\n3 0 1 0 2 1 .5 "
      ".5\n"
      "4 0 0 1 3 1\n$EndParametricNodes\n$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n");
  EXPECT_EQ(mesh.points.at(3), (Vec3{0, 0, 1}));
  EXPECT_EQ(mesh.cells.size(), 1U);
}

class GmshByteOrder : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Orders, GmshByteOrder, testing::Bool());

TEST_P(GmshByteOrder, Version41IsReadInEither) {
  Bytes file(GetParam());
  file.text("$MeshFormat\n4.1 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n$Entities\n");
  file.put<std::uint64_t>({0, 0, 0, 1}).put<int>({5}).put<double>({0, 0, 0, 1, 1, 1});
  file.put<std::uint64_t>({1}).put<int>({7}).put<std::uint64_t>({0}).text("\n$EndEntities\n$Nodes\n");
  file.put<std::uint64_t>({1, 4, 1, 4})
      .put<int>({3, 5, 0})
      .put<std::uint64_t>({4, 1, 2, 3, std::uint64_t{1} << 63});
  file.put<double>({0, 0, 0, 1.5, 0, 0, 0, 1, 0, 0, 0, 1}).text("\n$EndNodes\n$Elements\n");
  file.put<std::uint64_t>({1, 1, 1, 1}).put<int>({3, 5, 4});
  file.put<std::uint64_t>({1, 1, 1, 2, 3, std::uint64_t{1} << 63}).text("\n$EndElements\n");
  const MeshData mesh = read_file(file.str());
  EXPECT_EQ(mesh.points.at(1), (Vec3{1.5, 0, 0}));
  EXPECT_EQ(mesh.cells, (std::vector<std::array<Index, 4>>{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.regions, (std::vector<int>{7}));
}

TEST_P(GmshByteOrder, Version2IsReadInEither) {
  Bytes file(GetParam());
  file.text("$MeshFormat\n2.2 1 8\n").put<int>({1}).text("\n$EndMeshFormat\n$Nodes\n4\n");
  for (const int tag : {4, 3, 2, 9}) file.put<int>({tag}).put<double>({0.25 * tag, 0, 1});
  file.text("\n$EndNodes\n$Elements\n2\n").put<int>({4, 2, 2, 1, 7, 1, 4, 3, 2, 9, 2, 8, 2, 9, 2, 3, 4});
  const MeshData mesh = read_file(file.text("\n$EndElements\n").str());
  EXPECT_EQ(mesh.points.at(0).x, 1.0);
  EXPECT_EQ(mesh.cells, (std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {3, 2, 1, 0}}));
  EXPECT_EQ(mesh.regions, (std::vector<int>{7, 8}));
}

}  // namespace
}  // namespace hfr::io
