// SPDX-License-Identifier: BSD-3-Clause
#include "IO/FieldProperties.hh"

#include <gtest/gtest.h>

#include "HalfFace/Generate.hh"
#include "HalfFace/Writer.hh"
#include "IO/Assemble.hh"

namespace hfr::io {
namespace {

Field ramp(const std::string& name, int components, std::size_t n, bool integer = false) {
  Field field{name, components, integer, {}};
  for (std::size_t i = 0; i < n * static_cast<std::size_t>(components); ++i)
    field.values.push_back(integer ? static_cast<double>(i) : 0.1 * static_cast<double>(i));
  return field;
}

MeshData box_with_fields() {
  generate::Arrays box = generate::box({2, 1, 1});
  MeshData data;
  data.points = std::move(box.points);
  data.cells = std::move(box.cells);
  for (const int components : {1, 2, 3, 4, 5, 6, 9})
    for (const bool integer : {false, true}) {
      if (components == 5 && integer) continue;
      const std::string name = std::to_string(components) + (integer ? " integers" : " reals");
      data.point_fields.push_back(ramp(name, components, data.points.size(), integer));
      data.cell_fields.push_back(ramp(name, components, data.cells.size(), integer));
    }
  return data;
}

void expect_equal(const std::vector<Field>& a, const std::vector<Field>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].components, b[i].components) << a[i].name;
    EXPECT_EQ(a[i].integer, b[i].integer) << a[i].name;
    EXPECT_EQ(a[i].values, b[i].values) << a[i].name;
  }
}

TEST(FieldProperties, FieldsOfEveryShapeComeBack) {
  const MeshData data = box_with_fields();
  std::vector<std::string> notes;
  const MeshData back = disassemble(assemble(data, {}, nullptr, &notes));
  expect_equal(data.point_fields, back.point_fields);
  expect_equal(data.cell_fields, back.cell_fields);
  EXPECT_TRUE(notes.empty());
}

TEST(FieldProperties, UsersReachThemByName) {
  TetMesh mesh = assemble(box_with_fields());
  EXPECT_EQ(mesh.request_vertex_property<double>("1 reals")[VertexHandle(3)], 0.1 * 3);
  EXPECT_EQ(mesh.request_cell_property<Vec3>("3 reals")[CellHandle(1)].z, 0.1 * 5);
  EXPECT_EQ(mesh.request_cell_property<std::int64_t>("1 integers")[CellHandle(7)], 7);
}

TEST(FieldProperties, PropertiesOfAProgramBecomeFields) {
  TetMesh mesh = assemble(box_with_fields());
  mesh.request_cell_property<bool>("flag", false)[CellHandle(2)] = true;
  mesh.request_vertex_property<int>("count", -1);
  mesh.request_vertex_property<std::string>("text");  // of no type that a file could hold
  const MeshData back = disassemble(mesh);
  const Field& flag = back.cell_fields.back();
  EXPECT_EQ(flag.name, "flag");
  EXPECT_TRUE(flag.integer);
  EXPECT_EQ(flag.values[2], 1);
  EXPECT_EQ(flag.values[3], 0);
  EXPECT_EQ(back.point_fields.back().name, "count");
  EXPECT_EQ(back.point_fields.back().values[0], -1);
}

TEST(FieldProperties, ValuesOfDeletedVerticesAndCellsAreLeftOut) {
  TetMesh mesh = assemble(box_with_fields());
  TetMesh::Writer(mesh).mark_deleted(CellHandle(4));
  TetMesh::Writer(mesh).free_cells().push_back(CellHandle(4));
  TetMesh::Writer(mesh).mark_deleted(VertexHandle(0));
  const MeshData back = disassemble(mesh);
  EXPECT_EQ(back.cell_fields[1].values, (std::vector<double>{0, 1, 2, 3, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(back.point_fields[1].values[0], 1);
}

TEST(FieldProperties, FieldWithoutANameIsKept) {
  MeshData data = box_with_fields();
  const Field nameless = ramp("", 1, data.points.size());
  data.point_fields = {nameless};
  const TetMesh mesh = assemble(data);
  ASSERT_EQ(point_fields(mesh).size(), 1U);
  EXPECT_EQ(point_fields(mesh)[0].name, "unnamed");
  EXPECT_EQ(point_fields(mesh)[0].values, nameless.values);
}

TEST(FieldProperties, SecondFieldOfANameIsLeftOutAndSaid) {
  MeshData data = box_with_fields();
  data.cell_fields.push_back(ramp("1 reals", 3, data.cells.size()));
  std::vector<std::string> notes;
  const MeshData back = disassemble(assemble(data, {}, nullptr, &notes));
  EXPECT_EQ(back.cell_fields.size(), data.cell_fields.size() - 1);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0], "a second cell field '1 reals' was left out");
}

TEST(FieldProperties, IntegersThatAreNoneStayWhatTheyAre) {
  MeshData data = box_with_fields();
  data.point_fields = {ramp("half", 1, data.points.size(), true)};
  data.point_fields[0].values[1] = 0.5;
  data.point_fields[0].values[2] = 1e300;
  const MeshData back = disassemble(assemble(data));
  EXPECT_EQ(back.point_fields[0].values, data.point_fields[0].values);
  EXPECT_FALSE(back.point_fields[0].integer);
}

TEST(FieldProperties, FieldOfAnotherLengthIsRefused) {
  MeshData data = box_with_fields();
  data.point_fields[0].values.pop_back();
  EXPECT_THROW(assemble(data), InvalidInput);
}

}  // namespace
}  // namespace hfr::io
