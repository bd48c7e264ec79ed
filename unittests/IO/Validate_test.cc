// SPDX-License-Identifier: BSD-3-Clause
#include "IO/Validate.hh"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "IO/Linearise.hh"
#include "IO/MeshDataSamples.hh"

namespace hfr::io {
namespace {

TEST(Validate, TheSamplesKeepEveryRule) {
  EXPECT_NO_THROW(validate(samples::two_cells(), "f"));
  EXPECT_NO_THROW(validate(samples::full(), "f"));
  EXPECT_NO_THROW(validate(MeshData{}, "f"));
}

TEST(Validate, EveryBrokenRuleIsNamed) {
  const struct {
    const char* message;
    std::function<void(MeshData&)> breaks;
  } kRules[] = {
      {"f: point 2: a coordinate is not finite",
       [](MeshData& m) { m.points[2].y = std::numeric_limits<double>::quiet_NaN(); }},
      {"f: point 0: a coordinate is not finite",
       [](MeshData& m) { m.points[0].z = std::numeric_limits<double>::infinity(); }},
      {"f: cell 1: vertex 99 is out of range (the file has 5 points)",
       [](MeshData& m) { m.cells[1][3] = 99; }},
      {"f: triangle 2: vertex 5 is out of range (the file has 5 points)",
       [](MeshData& m) { m.triangles[2][0] = 5; }},
      {"f: edge 0: vertex 5 is out of range (the file has 5 points)", [](MeshData& m) { m.edges[0][1] = 5; }},
      {"f: fixed vertex 7 is out of range (the file has 5 points)",
       [](MeshData& m) { m.fixed_vertices[0] = 7; }},
      {"f: regions: 1 entries where 2 are needed", [](MeshData& m) { m.regions.pop_back(); }},
      {"f: triangle labels: 2 entries where 3 are needed", [](MeshData& m) { m.triangle_labels.pop_back(); }},
      {"f: edge labels: 3 entries where 2 are needed", [](MeshData& m) { m.edge_labels.push_back(0); }},
      {"f: vertex labels: 4 entries where 5 are needed", [](MeshData& m) { m.vertex_labels.pop_back(); }},
      {"f: point field 'velocity': 14 entries where 15 are needed",
       [](MeshData& m) { m.point_fields[1].values.pop_back(); }},
      {"f: cell field 'rank': has no components", [](MeshData& m) { m.cell_fields[1].components = 0; }},
  };
  for (const auto& rule : kRules) {
    MeshData mesh = samples::full();
    rule.breaks(mesh);
    try {
      validate(mesh, "f");
      ADD_FAILURE() << "not found: " << rule.message;
    } catch (const InvalidInput& error) {
      EXPECT_STREQ(error.what(), rule.message);
    }
  }
}

TEST(Linearise, PointsThatAnotherElementUsesStay) {
  MeshData mesh = samples::full();
  const MeshData before = mesh;
  drop_midside_points(mesh, {0, 1, 2, 3, 4, 4, 1000});
  EXPECT_EQ(mesh.points, before.points);
  EXPECT_EQ(mesh.cells, before.cells);
}

TEST(Linearise, EverythingThatBelongsToADroppedPointGoesWithIt) {
  MeshData mesh = samples::full();
  mesh.cells = {{1, 2, 3, 4}};
  mesh.triangles = {{4, 2, 3}};
  mesh.edges = {{3, 4}};
  mesh.fixed_vertices = {0, 4};
  drop_midside_points(mesh, {0});
  EXPECT_EQ(mesh.points.size(), 4U);
  EXPECT_EQ(mesh.cells[0], (std::array<Index, 4>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.triangles[0], (std::array<Index, 3>{3, 1, 2}));
  EXPECT_EQ(mesh.edges[0], (std::array<Index, 2>{2, 3}));
  EXPECT_EQ(mesh.fixed_vertices, std::vector<Index>{3});
  EXPECT_EQ(mesh.vertex_labels, (std::vector<int>{31, 0, 32, 0}));
  EXPECT_EQ(mesh.point_fields[0].values.size(), 4U);
  EXPECT_EQ(mesh.point_fields[1].values[0], 4);
}

TEST(Linearise, LabelsOfDroppedPointsLeaveNoZerosBehind) {
  MeshData mesh = samples::full();
  mesh.cells = {{1, 2, 3, 4}};
  mesh.triangles.clear();
  mesh.edges.clear();
  mesh.vertex_labels = {7, 0, 0, 0, 0};
  drop_midside_points(mesh, {0});
  EXPECT_TRUE(mesh.vertex_labels.empty());
}

}  // namespace
}  // namespace hfr::io
