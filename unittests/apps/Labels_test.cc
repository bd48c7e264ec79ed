// SPDX-License-Identifier: BSD-3-Clause
// What labels, fixed vertices and fields of a file mean to a run, and what check and improve both call a
// mesh.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "Tool.hh"
#include "hfremesh/IO/MeshFile.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Two cells on a common face that is a triangle of the file, and a hopeless fold: with the face kept,
/// nothing can open it; without it, three cells round a new edge do.
std::string folded_with(const std::string& triangles) {
  const std::string cells = kFoldedCells;
  return cells.substr(0, cells.find("End")) + triangles + "End\n";
}

TEST(Labels, InnerTrianglesOfLabelZeroAreKeptAndSaidSo) {
  Tool tool;
  tool.write("in.mesh", folded_with("Triangles\n1\n1 2 3 0\n"));
  const Outcome kept = tool.run("in.mesh -o kept.mesh");
  EXPECT_EQ(kept.code, 4) << kept.err;
  EXPECT_THAT(kept.err, HasSubstr("1 triangles of label 0 lie inside and are kept as they are"));
  const Outcome ignored = tool.run("in.mesh -o out.mesh --ignore-labels --json report.json");
  EXPECT_EQ(ignored.code, 0) << ignored.err;
  EXPECT_THAT(ignored.err, AllOf(HasSubstr("labels left out (--ignore-labels): of 1 triangles, 0 edges"),
                                 Not(HasSubstr("label 0"))));
  EXPECT_EQ(json::parse(tool.content("report.json"))["output"]["triangles"], 0);
  EXPECT_EQ(tool.run("check out.mesh").code, 0);
}

TEST(Labels, IgnoringThemKeepsThoseOfAFrozenSurface) {
  Tool tool;
  tool.write("in.mesh", folded_with("Triangles\n3\n1 2 3 7\n1 2 4 8\n2 3 4 0\n"));
  const Outcome outcome = tool.run("in.mesh -o out.mesh --ignore-labels");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(tool.content("out.mesh"),
              AllOf(HasSubstr("Triangles\n2\n"), HasSubstr(" 8\n"), Not(HasSubstr(" 7\n"))));
}

TEST(Labels, TrianglesOfTheBoundaryAreNoNews) {
  Tool tool;
  tool.write("in.mesh", folded_with("Triangles\n1\n1 2 4 0\n"));
  const Outcome outcome = tool.run("in.mesh -o out.mesh");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, IsEmpty());
}

constexpr const char* kField =
    "POINT_DATA 27\nSCALARS heat double 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 "
    "18 19 "
    "20 21 22 23 24 25 26\n";

TEST(Fields, ThoseOfVerticesThatMoveAreSaidToBeAttached) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 2 2 2 --jitter 0.9 --seed 3 -o in.vtk").code, 0);
  tool.write("in.vtk", tool.content("in.vtk") + kField);
  const Outcome outcome = tool.run("in.vtk -o out.vtk --ops smooth");
  EXPECT_THAT(outcome.err,
              HasSubstr("fields of vertices ('heat') are attached, not carried over: 1 of 27 vertices"));
}

TEST(Fields, NothingIsSaidWhereNoVertexMoves) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 2 2 2 -o in.vtk").code, 0);
  tool.write("in.vtk", tool.content("in.vtk") + kField);
  EXPECT_THAT(tool.run("in.vtk -o out.vtk --min-dihedral 20").err, IsEmpty());
}

TEST(Fields, FloatsThatFixVerticesAreKeptByEveryMode) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 2 2 2 --jitter 0.9 --seed 3 -o in.vtk").code, 0);
  const std::string inner = tool.content("in.vtk");
  const auto with_fixed = [&](const char* type, int which) {
    std::string text = inner + "POINT_DATA 27\nSCALARS fixed " + type + " 1\nLOOKUP_TABLE default\n";
    for (int i = 0; i < 27; ++i) text += i == which ? "1\n" : "0\n";
    return text;
  };
  const Vec3 inside = io::read_mesh(tool.path("in.vtk")).points[13];
  int n_modes = 0;
  for (const char* type : {"float", "int"}) {
    tool.write("in.vtk", with_fixed(type, 13));
    for (const char* mode : {"", " --surface flat", " --surface free"}) {
      const Outcome outcome = tool.run(std::string("in.vtk -o out.mesh") + mode);
      if (outcome.code == 1) continue;  // a build without OpenMesh
      ++n_modes;
      ASSERT_NE(outcome.code, 2);
      const io::MeshData out = io::read_mesh(tool.path("out.mesh"));
      ASSERT_EQ(out.fixed_vertices.size(), 1U) << type << mode;
      EXPECT_EQ(out.points[out.fixed_vertices[0]], inside) << type << mode;
      EXPECT_TRUE(out.point_fields.empty());
    }
  }
  EXPECT_TRUE(n_modes == 6 || n_modes == 2);
}

/// Two cells that touch along an edge, and at a vertex.
constexpr const char* kAtAnEdge =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n6\n0 0 0 0\n0 0 1 0\n1 0 0 0\n0 1 0 0\n-1 0 0 0\n0 -1 0 "
    "0\n"
    "Tetrahedra\n2\n1 3 4 2 0\n1 5 6 2 0\nEnd\n";
constexpr const char* kAtAVertex =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n7\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n-1 0 0 0\n0 -1 0 "
    "0\n"
    "0 0 -1 0\nTetrahedra\n2\n1 2 3 4 0\n1 6 5 7 0\nEnd\n";

TEST(Definition, CheckAndImproveTakePartsThatOnlyTouch) {
  Tool tool;
  for (const char* mesh : {kAtAnEdge, kAtAVertex}) {
    tool.write("in.mesh", mesh);
    const Outcome checked = tool.run("check in.mesh --json report.json");
    const Outcome improved = tool.run("in.mesh -o out.mesh");
    EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
    EXPECT_EQ(improved.code, 0) << improved.err;
    EXPECT_EQ(tool.run("check out.mesh").code, 0);
    EXPECT_THAT(checked.out, HasSubstr(", which is no fault"));
    const json result = json::parse(tool.content("report.json"))["result"];
    EXPECT_EQ(result["valid"], true);
    EXPECT_EQ(result["manifold"], false);
    EXPECT_TRUE(result["structure"].is_string());
    const Outcome strict = tool.run("check in.mesh --manifold");
    EXPECT_EQ(strict.code, 4);
    EXPECT_THAT(strict.out, Not(HasSubstr("no fault")));
  }
  tool.write("good.mesh", kTwoCells);
  EXPECT_EQ(tool.run("check good.mesh --manifold").code, 0);
}

#ifdef HFR_REPRO_MESHES
/// Whatever goes wrong inside, what is written can be read again, or the old file stays.
TEST(Definition, NothingIsWrittenThatCannotBeRead) {
  Tool tool;
  for (const std::string name : {"case1962.vtu", "case2533.vtu", "case100603.vtu"}) {
    const std::filesystem::path source = std::filesystem::path(HFR_REPRO_MESHES) / name;
    if (!std::filesystem::exists(source)) GTEST_SKIP() << "no " << source;
    std::filesystem::copy_file(source, tool.path(name), std::filesystem::copy_options::overwrite_existing);
    const std::string before = tool.content(name);
    const Outcome outcome = tool.run(name + " -o " + name + " -j 1");
    if (outcome.code == 7) {
      EXPECT_TRUE(tool.content(name) == before) << name;
      EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
    EXPECT_NE(tool.run("check " + name).code, 2) << name << ": " << outcome.code;
  }
}
#endif

}  // namespace
}  // namespace hfr::app::test
