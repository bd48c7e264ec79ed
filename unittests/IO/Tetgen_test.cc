// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "IO/MeshDataSamples.hh"

namespace hfr::io {
namespace {

using samples::mentions;
using samples::message_of_reading;
using samples::TemporaryFolder;
using ::testing::ElementsAre;

constexpr const char* kNodes = "# points\n4 3 0 0\n1 0 0 0\n2 1 0 0 # second\n\n3 0 1 0\n4 0 0 1\n";

MeshData read_set(const std::string& nodes, const std::string& cells, const std::string& faces = "",
                  const std::string& edges = "") {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "a.1.node", nodes);
  if (!cells.empty()) samples::write_bytes(folder / "a.1.ele", cells);
  if (!faces.empty()) samples::write_bytes(folder / "a.1.face", faces);
  if (!edges.empty()) samples::write_bytes(folder / "a.1.edge", edges);
  return read_mesh(folder / "a.1.node");
}

TEST(Tetgen, NumbersCountFromOneOrZeroAsTheFirstPointSays) {
  const std::array<Index, 4> cell = {0, 1, 2, 3};
  EXPECT_THAT(read_set(kNodes, "1 4 0\n1 1 2 3 4\n").cells, ElementsAre(cell));
  EXPECT_THAT(read_set("4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", "1 4 0\n0 0 1 2 3\n").cells,
              ElementsAre(cell));
}

TEST(Tetgen, AnyOfTheThreeNamesFindsTheSet) {
  const TemporaryFolder folder;
  write_mesh(folder / "b.ele", samples::full());
  for (const char* const name : {"b.node", "b.ele", "b.face"}) {
    EXPECT_EQ(read_mesh(folder / name).cells.size(), 2U) << name;
    EXPECT_EQ(read_mesh(folder / name).triangles.size(), 3U) << name;
    EXPECT_EQ(read_mesh(folder / name).edges.size(), 2U) << name;
  }
}

TEST(Tetgen, AttributesAndMarkersOfPoints) {
  const MeshData mesh = read_set("2 3 2 1\n1 0 0 0 0.5 7 -1\n2 1 0 0 1.5 8 3\n", "");
  EXPECT_THAT(mesh.vertex_labels, ElementsAre(-1, 3));
  ASSERT_EQ(mesh.point_fields.size(), 2U);
  EXPECT_EQ(mesh.point_fields[1].name, "attribute_2");
  EXPECT_THAT(mesh.point_fields[1].values, ElementsAre(7, 8));
  EXPECT_TRUE(mentions(mesh.notes, "no a.1.ele"));
}

TEST(Tetgen, TheFirstAttributeOfACellIsItsRegionIfItIsWhole) {
  const MeshData whole = read_set(kNodes, "2 4 2\n1 1 2 3 4 3.0 0.5\n2 1 2 4 3 -2 1.5\n");
  EXPECT_THAT(whole.regions, ElementsAre(3, -2));
  ASSERT_EQ(whole.cell_fields.size(), 1U);
  EXPECT_EQ(whole.cell_fields[0].name, "attribute_2");
  const MeshData broken = read_set(kNodes, "2 4 1\n1 1 2 3 4 3.5\n2 1 2 4 3 2\n");
  EXPECT_TRUE(broken.regions.empty());
  ASSERT_EQ(broken.cell_fields.size(), 1U);
  EXPECT_THAT(broken.cell_fields[0].values, ElementsAre(3.5, 2));
}

TEST(Tetgen, CellsOfTenPointsAreMadeLinear) {
  std::string nodes = "10 3 0 0\n";
  for (int i = 0; i < 10; ++i) nodes += std::to_string(i) + " " + std::to_string(i) + " 0 0\n";
  const MeshData mesh =
      read_set(nodes, "1 10 1\n0 9 8 7 6 5 4 3 2 1 0 4\n", "1 1\n0 9 8 7 5 4 3 6 -1 0\n", "1 1\n0 9 8 5 2\n");
  EXPECT_EQ(mesh.points.size(), 4U);
  EXPECT_THAT(mesh.cells, ElementsAre(std::array<Index, 4>{3, 2, 1, 0}));
  EXPECT_THAT(mesh.regions, ElementsAre(4));
  EXPECT_THAT(mesh.triangles, ElementsAre(std::array<Index, 3>{3, 2, 1}));
  EXPECT_THAT(mesh.triangle_labels, ElementsAre(6));
  EXPECT_THAT(mesh.edge_labels, ElementsAre(2));
  EXPECT_TRUE(mentions(mesh.notes, "1 cells of 10 points were made linear"));
}

TEST(Tetgen, FacesWithNeighboursAndWithoutMarkers) {
  const char* const kCells = "1 4 0\n1 1 2 3 4\n";
  const MeshData with = read_set(kNodes, kCells, "2 1\n1 1 2 3 5 1 -1\n2 1 2 4 6 1 -1\n");
  EXPECT_THAT(with.triangle_labels, ElementsAre(5, 6));
  const MeshData without = read_set(kNodes, kCells, "1 0\n0 1 2 3\n");
  EXPECT_THAT(without.triangles, ElementsAre(std::array<Index, 3>{0, 1, 2}));
  EXPECT_THAT(without.triangle_labels, ElementsAre(0));
}

TEST(Tetgen, FacesOfAMeshThatStoodHereBeforeAreReplaced) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.node", samples::full());
  write_mesh(folder / "a.node", samples::two_cells());
  EXPECT_TRUE(read_mesh(folder / "a.node").triangles.empty());
  EXPECT_TRUE(read_mesh(folder / "a.node").edges.empty());
}

TEST(Tetgen, BrokenFilesAreRefusedWithTheirLine) {
  const TemporaryFolder folder;
  EXPECT_EQ(message_of_reading(folder, "a.ele", "1 4 0\n1 1 2 3 4\n"),
            "a.node: cannot be opened: the points of a TetGen mesh are missing");
  samples::write_bytes(folder / "a.node", kNodes);
  const auto message = [&](const std::string& text) { return message_of_reading(folder, "a.ele", text); };
  EXPECT_EQ(message(""), "a.ele: the file is empty");
  EXPECT_EQ(message("1 4 0\n1 1 2 3 5\n"), "a.ele:2: vertex 5 is out of range (1 to 4)");
  EXPECT_EQ(message("2 4 0\n1 1 2 3 4\n3 1 2 3 4\n"), "a.ele:3: number 3 is out of range (2 to 2)");
  EXPECT_EQ(message("1 8 0\n1 1 2 3 4\n"), "a.ele:1: cells of 8 points: only 4 or 10 are read");
  EXPECT_EQ(message("1 4 0\n1 1 2 3 4\n2 1 2 3 4\n"), "a.ele:3: more lines than the first line says");
  EXPECT_EQ(message("2 4 0\n1 1 2 3 4\n").substr(0, 8), "a.ele:1:");
  EXPECT_EQ(message("1000000000000000000 4 0\n"),
            "a.ele:1: number of cells 1000000000000000000 is more than the rest of the file can hold");
  EXPECT_EQ(message("1 4 1000000000000000000\n1 1 2 3 4\n").substr(0, 8), "a.ele:1:");
  EXPECT_EQ(message_of_reading(folder, "b.node", "1 3 0 0\n5 0 0 0\n"),
            "b.node:2: first number 5 is out of range (0 to 1)");
  EXPECT_EQ(message_of_reading(folder, "b.node", "1 2 0 0\n1 0 0\n"),
            "b.node:1: dimension 2 is out of range (3 to 3)");
  EXPECT_EQ(message_of_reading(folder, "b.node", "1 3 0 0\n1 0 inf 0\n"),
            "b.node:2: expected a finite number, found 'inf'");
}

TEST(Tetgen, ALastLineWithoutEndGivesANote) {
  EXPECT_TRUE(mentions(read_set(kNodes, "1 4 0\n1 1 2 3 4").notes, "may have been cut short"));
}

TEST(Tetgen, RealMeshesHaveTheirCounts) {
  const struct {
    const char* name;
    std::size_t points, cells, regions;
  } kMeshes[] = {{"cleaver_short/output.node", 1248, 6183, 6183},
                 {"stellar_house2/house2.ele", 400, 1389, 0},
                 {"gaia_octopus30k/octopus_30K.1.node", 33113, 105440, 0}};
  for (const auto& expected : kMeshes) {
    const std::filesystem::path path = std::filesystem::path(HFR_TEST_MESHES) / expected.name;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    const MeshData mesh = read_mesh(path);
    EXPECT_EQ(mesh.points.size(), expected.points) << path;
    EXPECT_EQ(mesh.cells.size(), expected.cells) << path;
    EXPECT_EQ(mesh.regions.size(), expected.regions) << path;
  }
}

TEST(Tetgen, WithoutTheFlagTheFirstLineShowsWhetherThereAreMarkers) {
  const std::string cells = "1 4 0\n1 1 2 3 4\n";
  const MeshData plain = read_set(kNodes, cells, "2\n1 1 2 3\n2 1 2 4\n");
  EXPECT_EQ(plain.triangles.size(), 2U);
  EXPECT_TRUE(plain.triangle_labels.empty() || plain.triangle_labels == std::vector<int>(2));
  EXPECT_THAT(read_set(kNodes, cells, "2\n1 1 2 3 7\n2 1 2 4 8\n").triangle_labels, ElementsAre(7, 8));
}

TEST(Tetgen, NamesInCapitalsAreThoseOfTheWholeSet) {
  const TemporaryFolder folder;
  samples::write_bytes(folder / "B.node", "nothing of ours");
  write_mesh(folder / "B.NODE", samples::full());
  EXPECT_EQ(read_mesh(folder / "B.ELE").cells.size(), 2U);
  EXPECT_EQ(read_mesh(folder / "B.NODE").triangles.size(), 3U);
  EXPECT_EQ(samples::read_bytes(folder / "B.node"), "nothing of ours");
  EXPECT_THAT(files_of_mesh("x/B.NODE"),
              testing::UnorderedElementsAre("x/B.NODE", "x/B.ELE", "x/B.FACE", "x/B.EDGE"));
}

}  // namespace
}  // namespace hfr::io
