// SPDX-License-Identifier: BSD-3-Clause
// What must hold for every format that holds cells: write, read, compare.
#include "IO/MeshFile.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <limits>

#include "HalfFace/Errors.hh"
#include "IO/MeshDataSamples.hh"
#include "IO/WritableFormats.hh"

namespace hfr::io {
namespace {

using samples::FormatVariant;
using samples::mentions;
using samples::TemporaryFolder;

class EveryFormat : public testing::TestWithParam<FormatVariant> {
 protected:
  MeshData round_trip(const MeshData& mesh) {
    notes_ = write_mesh(path_, mesh, GetParam().options);
    return read_mesh(path_);
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / ("mesh" + GetParam().extension);
  std::vector<std::string> notes_;
};

/// The field of this name or, where a format drops names and says so, the one with the same values.
bool has_field(const std::vector<Field>& fields, const Field& wanted) {
  return std::any_of(fields.begin(), fields.end(), [&](const Field& field) {
    return field.components == wanted.components && samples::same_bits(field.values, wanted.values);
  });
}

/// Whether the values are to be written as integers is a hint, not something that can be lost.
bool has_name(const std::vector<Field>& fields, const Field& wanted) {
  return std::any_of(fields.begin(), fields.end(), [&](const Field& field) {
    return field.name == wanted.name && field.components == wanted.components &&
           samples::same_bits(field.values, wanted.values);
  });
}

TEST_P(EveryFormat, PointsAndCellsSurviveBitForBit) {
  const MeshData mesh = samples::full();
  const MeshData back = round_trip(mesh);
  EXPECT_TRUE(samples::same_bits(back.points, mesh.points));
  EXPECT_EQ(back.cells, mesh.cells);
}

TEST_P(EveryFormat, TheLowestAndTheHighestLabelSurvive) {
  constexpr int kLowest = std::numeric_limits<int>::min(), kHighest = std::numeric_limits<int>::max();
  MeshData mesh = samples::two_cells();
  mesh.regions = {kLowest, kHighest};
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}};
  mesh.triangle_labels = {kLowest, kHighest};
  mesh.edges = {{0, 1}, {1, 2}};
  mesh.edge_labels = {kLowest, kHighest};
  mesh.vertex_labels = {kLowest, kHighest, 0, 0, 1};
  const MeshData back = round_trip(mesh);
  EXPECT_EQ(back.regions, mesh.regions);
  EXPECT_EQ(back.triangle_labels, mesh.triangle_labels);
  EXPECT_EQ(back.edge_labels, mesh.edge_labels);
  EXPECT_EQ(back.vertex_labels, mesh.vertex_labels);
}

TEST_P(EveryFormat, FieldsOfNoCellsCanBeRead) {
  MeshData mesh = samples::two_cells();
  mesh.cells.clear();
  mesh.cell_fields = {{"wide", 9, false, {}}, {"wider", 12, false, {}}};
  EXPECT_EQ(round_trip(mesh).points.size(), mesh.points.size());
}

TEST_P(EveryFormat, NamesOfFieldsComeBackOrANoteSaysWhy) {
  MeshData mesh = samples::two_cells();
  mesh.point_fields = {{"6\" pipe", 1, false, {1, 2, 3, 4, 5}}, {"two\nlines", 1, false, {5, 4, 3, 2, 1}}};
  const MeshData back = round_trip(mesh);
  for (const Field& field : mesh.point_fields) {
    EXPECT_TRUE(has_name(back.point_fields, field) || !notes_.empty()) << field.name;
    EXPECT_TRUE(has_field(back.point_fields, field)) << field.name;
  }
}

TEST_P(EveryFormat, RandomBitPatternsSurvive) {
  const MeshData mesh = samples::random_bits(2000, 7);
  const MeshData back = round_trip(mesh);
  EXPECT_TRUE(samples::same_bits(back.points, mesh.points));
  EXPECT_EQ(back.cells, mesh.cells);
  EXPECT_EQ(back.regions, mesh.regions);
}

TEST_P(EveryFormat, WhatIsLostIsNamed) {
  const MeshData mesh = samples::full();
  const MeshData back = round_trip(mesh);
  EXPECT_EQ(back.regions, mesh.regions);
  if (back.triangles != mesh.triangles || back.triangle_labels != mesh.triangle_labels) {
    EXPECT_TRUE(mentions(notes_, "triangle"));
  }
  if (back.edges != mesh.edges || back.edge_labels != mesh.edge_labels) {
    EXPECT_TRUE(mentions(notes_, "edge"));
  }
  if (back.vertex_labels != mesh.vertex_labels) {
    EXPECT_TRUE(mentions(notes_, "label"));
  }
  if (back.fixed_vertices != mesh.fixed_vertices) {
    EXPECT_TRUE(mentions(notes_, "fixed"));
  }
  if (back.names != mesh.names) {
    EXPECT_TRUE(mentions(notes_, "names"));
  }
  for (const Field& field : mesh.point_fields) {
    if (!has_name(back.point_fields, field)) {
      EXPECT_TRUE(mentions(notes_, field.name)) << field.name;
    }
  }
  for (const Field& field : mesh.cell_fields) {
    if (!has_name(back.cell_fields, field)) {
      EXPECT_TRUE(mentions(notes_, field.name)) << field.name;
    }
  }
}

TEST_P(EveryFormat, AMeshOfPointsAndCellsOnlyComesBackWithoutTheRest) {
  const MeshData mesh = samples::two_cells();
  const MeshData back = round_trip(mesh);
  // Nothing is lost; one variant advises against itself.
  std::erase_if(notes_,
                [](const std::string& note) { return note.find("version 4.0") != std::string::npos; });
  EXPECT_TRUE(notes_.empty()) << notes_.front();
  EXPECT_EQ(back.points, mesh.points);
  EXPECT_EQ(back.cells, mesh.cells);
  EXPECT_TRUE(back.regions.empty());
  EXPECT_TRUE(back.triangles.empty());
  EXPECT_TRUE(back.edges.empty());
  EXPECT_TRUE(back.vertex_labels.empty());
  EXPECT_TRUE(back.fixed_vertices.empty());
  EXPECT_TRUE(back.names.empty());
  EXPECT_TRUE(back.point_fields.empty());
  EXPECT_TRUE(back.cell_fields.empty());
  EXPECT_TRUE(back.notes.empty()) << back.notes.front();
}

TEST_P(EveryFormat, ScalarFieldsKeepTheirValues) {
  MeshData mesh = samples::two_cells();
  mesh.regions = {1, 2};
  mesh.point_fields = {{"h", 1, false, {0.1, 0.2, 1e-300, -0.0, 4}}};
  mesh.cell_fields = {{"q", 1, false, {0.25, 1.0 / 3.0}}};
  const MeshData back = round_trip(mesh);
  EXPECT_TRUE(has_field(back.point_fields, mesh.point_fields[0]));
  EXPECT_TRUE(has_field(back.cell_fields, mesh.cell_fields[0]));
}

TEST_P(EveryFormat, HoldsFieldsAndSaysSo) {
  EXPECT_TRUE(holds_fields(path_, GetParam().options));  // the test above has seen them come back
}

TEST_P(EveryFormat, UnusedPointsAndInvertedCellsAreKept) {
  MeshData mesh = samples::two_cells();
  mesh.points.insert(mesh.points.begin() + 2, Vec3{9, 9, 9});
  mesh.cells = {{1, 0, 3, 4}, {1, 3, 4, 5}};
  const MeshData back = round_trip(mesh);
  EXPECT_EQ(back.points, mesh.points);
  EXPECT_EQ(back.cells, mesh.cells);
}

TEST_P(EveryFormat, WritingTwiceGivesTheSameBytes) {
  write_mesh(path_, samples::full(), GetParam().options);
  const std::string first = samples::read_bytes(path_);
  write_mesh(path_, samples::full(), GetParam().options);
  EXPECT_EQ(samples::read_bytes(path_), first);
}

TEST_P(EveryFormat, AMeshThatBreaksARuleIsNotWritten) {
  MeshData mesh = samples::two_cells();
  mesh.cells[1][2] = 99;
  EXPECT_THROW(write_mesh(path_, mesh, GetParam().options), InvalidInput);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 0) << "no file is left";
}

INSTANTIATE_TEST_SUITE_P(MeshFile, EveryFormat, testing::ValuesIn(samples::cell_formats()),
                         [](const auto& format) { return format.param.name(); });

TEST(MeshFile, UnknownAndMissingFilesAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT(samples::message_of_reading(folder, "a.step", "x"),
              testing::StartsWith("a.step: unknown file type '.step'; known are .mesh "));
  EXPECT_THROW(read_mesh(folder / "none.mesh"), IoError);
  EXPECT_THROW(write_mesh(folder / "none/a.mesh", samples::two_cells()), IoError);
}

TEST(MeshFile, SurfacesAndSolutionsThatAStreamCannotTakeHoldNoFields) {
  for (const char* name : {"a.stl", "a.obj", "a.off", "a.ply"}) EXPECT_FALSE(holds_fields(name, {})) << name;
  EXPECT_FALSE(holds_fields(kStandardOutput, {.format = "mesh"}));
  EXPECT_TRUE(holds_fields(kStandardOutput, {.format = "vtu"}));
  EXPECT_THROW(holds_fields("a.stuff", {}), InvalidInput);
}

TEST(MeshFile, ExtensionsAreKnownInCapitalsToo) {
  const TemporaryFolder folder;
  write_mesh(folder / "A.MESH", samples::two_cells());
  EXPECT_EQ(read_mesh(folder / "A.MESH").cells.size(), 2U);
}

TEST(MeshFile, AVariantThatTheFormatHasNotIsRefusedBeforeAnyMeshIsThere) {
  EXPECT_NO_THROW(require_writable_format("a.vtu", {.variant = "zlib"}));
  EXPECT_NO_THROW(require_writable_format("-", {.variant = "4.1", .format = "msh"}));
  EXPECT_THROW(require_writable_format("a.vtu", {.variant = "4.1"}), InvalidInput);
  EXPECT_THROW(require_writable_format("a.msh", {.variant = "4"}), InvalidInput);
  EXPECT_THROW(require_writable_format("a.msh", {.variant = "4.0 4.1"}), InvalidInput);
  EXPECT_THROW(require_writable_format("a.mesh", {.variant = "ascii"}), InvalidInput) << "it has none";
  EXPECT_THROW(require_writable_format("a.xyz", {}), InvalidInput);
}

TEST(MeshFile, EveryVariantThatIsTriedIsKnownBeforehand) {
  for (const FormatVariant& format : samples::cell_formats())
    EXPECT_NO_THROW(require_writable_format("a" + format.extension, format.options)) << format.name();
}

TEST(MeshFile, FilesOfAMeshAreTheOnesBesideItToo) {
  using ::testing::UnorderedElementsAre;
  EXPECT_THAT(files_of_mesh("x/a.ele"), UnorderedElementsAre("x/a.node", "x/a.ele", "x/a.face", "x/a.edge"));
  EXPECT_THAT(files_of_mesh("a.mesh"), UnorderedElementsAre("a.mesh", "a.sol", "a.solb"));
  EXPECT_THAT(files_of_mesh("a.vtu"), UnorderedElementsAre("a.vtu"));
}

}  // namespace
}  // namespace hfr::io
