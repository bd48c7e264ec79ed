// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "Tool.hh"
#include "hfremesh/HalfFace/Generate.hh"
#include "hfremesh/IO/ReadWrite.hh"
#include "hfremesh/Quality/Statistics.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A jittered box, with what it is moved by: a swirl in its middle, `strength` times as far as cells are
/// wide.
TetMesh box(double strength) {
  const generate::Arrays arrays = generate::jittered_box({6, 6, 6}, 0.1, 2);
  TetMesh mesh = build(arrays.points, arrays.cells);
  auto by = mesh.request_vertex_property<Vec3>("u");
  auto heat = mesh.request_vertex_property<double>("T");
  auto mass = mesh.request_cell_property<double>("mass");
  for (VertexHandle v : mesh.vertices()) {
    const Vec3 p = mesh.point(v) - Vec3{0.5, 0.5, 0.5};
    if (norm(p) < 0.36) by[v] = strength / 6 * Vec3{-p.y, p.x, 0} * (1 / std::max(norm(p), 0.1));
    heat[v] = 1 + 2 * mesh.point(v).x + 2 * by[v].x;  // linear in the places after the move
  }
  for (CellHandle c : mesh.cells()) mass[c] = 1 + c.idx() % 5;
  return mesh;
}

TEST(Move, MeshIsMovedRepairedAndItsFieldsAreCarriedOver) {
  Tool tool;
  io::write(tool.path("in.vtu"), box(1.2));
  const Outcome outcome =
      tool.run("move in.vtu --displacement u -o out.vtu --transfer mass:conserve --json report.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json report = json::parse(tool.content("report.json"));
  EXPECT_NE(report["step"]["cause"], "none");
  EXPECT_GT(report["step"]["repairs"][0]["cells_created"], 0);
  TetMesh mesh = io::read(tool.path("out.vtu"));
  EXPECT_GE(statistics(mesh).min_dihedral.min, 10);
  const auto heat = *mesh.get_vertex_property<double>("T");
  for (VertexHandle v : mesh.vertices()) ASSERT_NEAR(heat[v], 1 + 2 * mesh.point(v).x, 1e-12);
}

TEST(Move, FieldOfCellsCallsForARepair) {
  Tool tool;
  TetMesh before = box(0.05);
  auto marked = before.request_cell_property<double>("marked");
  io::write(tool.path("none.vtu"), before);
  for (CellHandle c : before.cells()) marked[c] = c.idx() % 7 == 0 ? 1 : 0;
  io::write(tool.path("some.vtu"), before);
  const auto cause = [&](const std::string& arguments) {
    const Outcome outcome = tool.run("move " + arguments + " --displacement u -o out.vtu --json r.json -q");
    EXPECT_EQ(outcome.code, 0) << arguments << ": " << outcome.err;
    return json::parse(tool.content("r.json"))["step"]["cause"].get<std::string>();
  };
  EXPECT_EQ(cause("some.vtu --trigger-field marked"), "indicator");
  EXPECT_EQ(cause("none.vtu --trigger-field marked"), "none");
  EXPECT_EQ(cause("some.vtu"), "none");
}

TEST(Move, MoveWithoutABadCellLeavesTheConnectivity) {
  Tool tool;
  const TetMesh before = box(0.05);
  io::write(tool.path("in.vtu"), before);
  ASSERT_EQ(tool.run("move in.vtu --displacement u -o out.vtu -q").code, 0);
  const TetMesh after = io::read(tool.path("out.vtu"));
  ASSERT_EQ(after.n_cells(), before.n_cells());
  for (CellHandle c : after.cells()) EXPECT_EQ(after.cell_vertices(c), before.cell_vertices(c));
}

TEST(Move, RefusedMoveNamesTheCellsAndWritesNothing) {
  Tool tool;
  io::write(tool.path("in.vtu"), box(3));
  const Outcome outcome = tool.run("move in.vtu --displacement u -o out.vtu --on-inversion refuse");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("was refused"));
  EXPECT_THAT(tool.files(), ElementsAre("in.vtu"));
}

TEST(Move, FilesOfTheSeriesAreNotWrittenOver) {
  Tool tool;
  for (int i = 0; i < 3; ++i) io::write(tool.path("in_000" + std::to_string(i) + ".vtu"), box(0.6));
  const std::string before = tool.content("in_0001.vtu");
  const Outcome outcome = tool.run("move --series in_%04d.vtu -o in.pvd");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("in_0000.vtu of the series would be written over; choose another name"));
  EXPECT_EQ(tool.content("in_0001.vtu"), before);
}

TEST(Move, NeitherReportNorCollectionTakesThePlaceOfAFileOfTheSeries) {
  Tool tool;
  for (int i = 0; i < 3; ++i) io::write(tool.path("in_" + std::to_string(i) + ".vtu"), box(0.6));
  const std::string before = tool.content("in_1.vtu");
  for (const char* name : {"in_1.vtu", "out_0001.vtu"}) {
    const Outcome outcome = tool.run(std::string("move --series in_%d.vtu -o out.pvd --json ") + name);
    EXPECT_EQ(outcome.code, 1) << name;
    EXPECT_THAT(outcome.err, HasSubstr("are the same file")) << name;
  }
  std::filesystem::create_symlink("in_1.vtu", tool.path("link.pvd"));
  EXPECT_EQ(tool.run("move --series in_%d.vtu -o link.pvd").code, 1);
  EXPECT_EQ(tool.content("in_1.vtu"), before);
  std::filesystem::remove(tool.path("link.pvd"));
  std::filesystem::create_directory(tool.path("out_0002.vtu"));
  EXPECT_EQ(tool.run("move --series in_%d.vtu -o out.pvd").code, 1);
  EXPECT_EQ(tool.run("move --series in_%d.vtu -o o.pvd --variant 4.1").code, 1);
  EXPECT_THAT(tool.files(), ElementsAre("in_0.vtu", "in_1.vtu", "in_2.vtu", "out_0002.vtu"))
      << "nothing was written";
}

TEST(Move, SeriesOfAMeshWithPinchedVerticesCanBeSplit) {
  Tool tool;
  // Two cells that meet in a vertex alone, of which each has one then.
  TetMesh mesh =
      build(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
            std::vector<std::array<Index, 4>>{{0, 1, 2, 3}, {0, 5, 4, 6}});
  for (int i = 0; i < 3; ++i) {
    io::write(tool.path("in_" + std::to_string(i) + ".vtu"), mesh);
    for (VertexHandle v : mesh.vertices()) mesh.set_point(v, mesh.point(v) + Vec3{0.01, 0, 0});
  }
  const Outcome outcome = tool.run("move --series in_%d.vtu -o out.pvd --split-nonmanifold");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const TetMesh last = io::read(tool.path("out_0002.vtu"));
  EXPECT_EQ(last.n_vertices(), 8U);
  EXPECT_NEAR(last.point(VertexHandle(7)).x, 0.02, 1e-12);
}

TEST(Move, SeriesBecomesACollectionWithAMeshAStep) {
  Tool tool;
  TetMesh mesh = box(0.6);
  const auto by = *mesh.get_vertex_property<Vec3>("u");
  for (int i = 0; i < 5; ++i) {
    io::write(tool.path("in_" + std::to_string(i) + ".vtu"), mesh);
    for (VertexHandle v : mesh.vertices()) mesh.set_point(v, mesh.point(v) + by[v]);
  }
  const Outcome outcome = tool.run("move --series in_%d.vtu -o out.pvd --json report.json");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const json report = json::parse(tool.content("report.json"));
  ASSERT_EQ(report["steps"].size(), 4U);
  EXPECT_EQ(report["steps"][3]["inverted"], 0);
  const std::string collection = tool.content("out.pvd");
  for (const char* name : {"out_0000.vtu", "out_0001.vtu", "out_0004.vtu"}) {
    EXPECT_THAT(collection, HasSubstr(name));
    const TetMesh step = io::read(tool.path(name));
    EXPECT_GE(statistics(step).min_dihedral.min, 10) << name;
    EXPECT_THAT(step.properties().vertices.names(), ::testing::UnorderedElementsAre("u", "T"));
  }
}

TEST(Move, SameBytesForAnyNumberOfThreads) {
  Tool tool;
  io::write(tool.path("in.vtu"), box(1.5));
  for (const char* threads : {"1", "2", "5"})
    ASSERT_EQ(
        tool.run(std::string(
                     "move in.vtu --displacement u --transfer mass:conserve --on-inversion substeps -q -j ") +
                 threads + " -o out" + threads + ".vtu")
            .code,
        0);
  EXPECT_EQ(tool.content("out1.vtu"), tool.content("out2.vtu"));
  EXPECT_EQ(tool.content("out1.vtu"), tool.content("out5.vtu"));
}

TEST(Move, WhatIsWrongIsSaidInALine) {
  Tool tool;
  io::write(tool.path("in.vtu"), box(0.5));
  const auto fails = [&](const std::string& arguments, int code, const std::string& says) {
    const Outcome outcome = tool.run("move " + arguments);
    EXPECT_EQ(outcome.code, code) << arguments << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
  };
  fails("in.vtu -o out.vtu", 1, "--displacement FIELD");
  fails("in.vtu --displacement v -o out.vtu", 1, "no field 'v' of three numbers");
  fails("in.vtu --displacement T -o out.vtu", 1, "no field 'T' of three numbers");
  fails("in.vtu --displacement u -o out.vtu --trigger 20", 1, "--trigger must not be above");
  fails("in.vtu --displacement u -o out.vtu --transfer mass", 1, "NAME:linear");
  fails("in.vtu --displacement u -o out.vtu --transfer mass:linear", 1, "'mass' is one of cells");
  fails("in.vtu --displacement u -o out.vtu --transfer mass:quadratic", 1, "'mass' is one of cells");
  fails("in.vtu --displacement u -o out.vtu --transfer none:conserve", 1, "no field 'none'");
  fails("in.vtu --displacement u -o out.vtu --trigger-field none", 1, "no field 'none'");
  fails("--series in_%d.vtu -o out.pvd", 2, "at least two files");
  fails("--series in_%d.vtu -o out.vtu", 1, "written as .pvd");
  fails("--series in.vtu -o out.pvd", 1, "%04d is wanted");
  EXPECT_THAT(tool.files(), ElementsAre("in.vtu"));
}

}  // namespace
}  // namespace hfr::app::test
