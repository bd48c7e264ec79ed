// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "Tool.hh"
#include "hfremesh/HalfFace/TetMesh.hh"
#include "hfremesh/IO/MeshFile.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

#ifdef HFR_HAS_SURFACE
constexpr bool kHasSurface = true;
#else
constexpr bool kHasSurface = false;
#endif

/// Hash of a mesh file as `stats` sees it.
std::string hash_of(Tool& tool, const std::string& file) {
  const Outcome outcome = tool.run("stats --json - " + file);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out)["meshes"][0]["hash"];
}

TEST(Commands, HelpNamesEverySubcommandAndOption) {
  Tool tool;
  const Outcome all = tool.run("--help");
  EXPECT_EQ(all.code, 0);
  EXPECT_THAT(all.out, AllOf(HasSubstr("improve"), HasSubstr("check"), HasSubstr("stats"),
                             HasSubstr("convert"), HasSubstr("generate")));
  EXPECT_THAT(all.err, IsEmpty());
  const Outcome improve = tool.run("improve --help");
  EXPECT_EQ(improve.code, 0);
  for (const char* option :
       {"--output", "--min-dihedral", "--iterations", "--time-limit", "--ops", "--metric", "--threads",
        "--compat", "--json", "--quiet", "--verbose", "--progress", "--dry-run"})
    EXPECT_THAT(improve.out, HasSubstr(option));
  for (const char* command : {"check", "stats", "convert", "generate", "generate cavity", "generate box",
                              "generate ball", "generate cylinder", "generate fandisk"})
    EXPECT_EQ(tool.run(std::string(command) + " --help").code, 0) << command;
}

TEST(Commands, VersionIsOneLine) {
  Tool tool;
  const Outcome outcome = tool.run("--version");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, ::testing::MatchesRegex("hfremesh [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Commands, ImproveIsWhatHappensWithoutASubcommand) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 6 6 6 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o a.mesh").code, 0);
  ASSERT_EQ(tool.run("improve in.mesh -o b.mesh").code, 0);
  ASSERT_EQ(tool.run("-q -o c.mesh in.mesh").code, 0);
  EXPECT_EQ(tool.content("a.mesh"), tool.content("b.mesh"));
  EXPECT_EQ(tool.content("a.mesh"), tool.content("c.mesh"));
}

TEST(Commands, ImproveMayOverwriteItsInput) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 6 6 6 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o other.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o in.mesh").code, 0);
  EXPECT_EQ(tool.content("in.mesh"), tool.content("other.mesh"));
  EXPECT_THAT(tool.files(), ElementsAre("in.mesh", "other.mesh"));
}

TEST(Commands, DryRunWritesNoMesh) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 6 6 6 -o in.mesh").code, 0);
  const Outcome outcome = tool.run("in.mesh --dry-run");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("nothing was written"));
  EXPECT_THAT(tool.files(), ElementsAre("in.mesh"));
}

TEST(Commands, MeshThatMeetsItsGoalIsUnchanged) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 4 4 4 -o in.mesh").code, 0);
  const Outcome outcome = tool.run("in.mesh -o out.mesh --min-dihedral 20");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("unchanged"));
  EXPECT_EQ(hash_of(tool, "in.mesh"), hash_of(tool, "out.mesh"));
}

TEST(Commands, OutputIsTheSameForAnyNumberOfThreads) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 12 12 12 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o one.mesh -j 1").code, 0);
  for (const char* threads : {"2", "3", "7"}) {
    ASSERT_EQ(tool.run(std::string("in.mesh -o many.mesh -j ") + threads).code, 0);
    EXPECT_TRUE(tool.content("one.mesh") == tool.content("many.mesh")) << threads << " threads";
  }
}

TEST(Commands, MinDihedralMaxRaisesTheWorstAboveTheDefaultRun) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 12 12 12 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o default.mesh --json default.json").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o most.mesh --min-dihedral max --json most.json").code, 0);
  const json most = json::parse(tool.content("most.json"));
  EXPECT_EQ(most["options"]["min_dihedral"], "max");
  EXPECT_GT(most["after"]["min_dihedral"]["min"].get<double>(),
            json::parse(tool.content("default.json"))["after"]["min_dihedral"]["min"].get<double>());
}

TEST(Commands, NoInsertAddsNoVertex) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  for (const char* flag : {"", " --no-insert"}) {
    ASSERT_EQ(tool.run(std::string("in.mesh -o out.mesh --min-dihedral max --json out.json") + flag).code, 0);
    bool inserted = false;
    const json report = json::parse(tool.content("out.json"));
    for (const json& pass : report["passes"])
      inserted = inserted || (pass["op"] == "insert" && pass["winners"] > 0);
    EXPECT_EQ(inserted, std::string(flag).empty());
  }
}

TEST(Commands, OutputIsTheSameWithAnyVectorInstructions) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 12 12 12 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o widest.mesh").code, 0);
  for (const char* vectors : {"baseline", "avx2"}) {
    ASSERT_EQ(tool.shell(std::string("HFR_VECTORS=") + vectors + " $TOOL in.mesh -o other.mesh").code, 0);
    EXPECT_TRUE(tool.content("widest.mesh") == tool.content("other.mesh")) << vectors;
  }
}

TEST(Commands, ImproveKeepsRegions) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 6 6 6 --jitter 0.3 --regions 2 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o out.mesh --json out.json").code, 0);
  const auto report = nlohmann::json::parse(tool.content("out.json"));
  ASSERT_EQ(report["after"]["regions"].size(), 2U);
  for (int r : {0, 1})
    EXPECT_NEAR(report["before"]["regions"][r]["volume"], report["after"]["regions"][r]["volume"], 1e-12);
}

TEST(Commands, ImproveKeepsLabelsAndNames) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 5 5 5 --jitter 0.4 --regions 2 -o box.vtu").code, 0);
  io::MeshData given = io::read_mesh(tool.path("box.vtu"));
  const TetMesh mesh = build(given.points, given.cells);
  for (HalfFaceHandle h : mesh.boundary_halffaces()) {
    const auto f = mesh.halfface_vertices(h);
    given.triangles.push_back({f[0].idx(), f[2].idx(), f[1].idx()});
    given.triangle_labels.push_back(mesh.point(f[0]).x == 0 && mesh.point(f[1]).x == 0 ? 7 : 8);
  }
  for (Index i = 0; i < 5; ++i) {  // an edge of the box: its vertices stand in a row
    given.edges.push_back({i, i + 1});
    given.edge_labels.push_back(5);
  }
  given.names = {{{2, 7}, "inflow"}, {{3, 1}, "steel"}};
  io::write_mesh(tool.path("in.vtu"), given);
  ASSERT_EQ(tool.run("in.vtu -o out.vtu --json report.json").code, 0);
  ASSERT_TRUE(nlohmann::json::parse(tool.content("report.json"))["result"]["changed"].get<bool>());
  const io::MeshData out = io::read_mesh(tool.path("out.vtu"));
  EXPECT_EQ(out.names, given.names);
  EXPECT_EQ(std::set(out.regions.begin(), out.regions.end()),
            std::set(given.regions.begin(), given.regions.end()));
  // Vertices of a frozen surface may have other numbers, so places are compared.
  const auto places = [](const io::MeshData& data, const auto& elements, const std::vector<int>& labels) {
    std::set<std::pair<std::set<std::array<double, 3>>, int>> all;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      std::set<std::array<double, 3>> corners;
      for (Index v : elements[i]) corners.insert({data.points[v].x, data.points[v].y, data.points[v].z});
      all.insert({corners, labels[i]});
    }
    return all;
  };
  EXPECT_EQ(places(out, out.triangles, out.triangle_labels),
            places(given, given.triangles, given.triangle_labels));
  EXPECT_EQ(places(out, out.edges, out.edge_labels), places(given, given.edges, given.edge_labels));
}

TEST(Commands, ImproveKeepsFields) {
  Tool tool;
  tool.write(
      "in.vtk",
      "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0\n1 0 0\n0 1 "
      "0\n"
      "0 0 1\n0.2 0.2 0.1\nCELLS 2 10\n4 0 1 2 3\n4 0 2 1 4\nCELL_TYPES 2\n10 10\nPOINT_DATA 5\n"
      "SCALARS heat double 1\nLOOKUP_TABLE default\n1 2 3 4 5.5\nVECTORS flow double\n1 0 0\n0 1 0\n0 0 1\n"
      "1 1 1\n0.5 0.5 0.5\n");
  ASSERT_EQ(tool.run("in.vtk -o out.vtk").code, 0);
  const std::string out = tool.content("out.vtk");
  EXPECT_THAT(out, AllOf(HasSubstr("heat"), HasSubstr("5.5"), HasSubstr("flow"), HasSubstr("0.5 0.5 0.5")));
}

TEST(Commands, CompatRunsThePaper) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  const Outcome outcome = tool.run("in.mesh -o out.mesh --compat jpdc2013 --iterations 2 --json out.json -v");
  EXPECT_TRUE(outcome.code == 0 || outcome.code == 4) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(tool.content("out.json"))["options"]["compat"], "jpdc2013");
}

TEST(Commands, CheckSaysWhatKindOfFaultItIs) {
  Tool tool;
  tool.write("good.mesh", kTwoCells);
  tool.write("flipped.mesh", kFlippedCells);
  tool.write("folded.mesh", kFoldedCells);
  tool.write("renumbered.mesh", kRenumberedCells);
  EXPECT_EQ(tool.run("check good.mesh").code, 0);

  const Outcome flipped = tool.run("check flipped.mesh");
  EXPECT_EQ(flipped.code, 0) << flipped.err;
  EXPECT_THAT(flipped.out, HasSubstr("the other way round as a whole, which is no fault"));

  const Outcome folded = tool.run("check folded.mesh --ids ids.txt");
  EXPECT_EQ(folded.code, 4);
  EXPECT_THAT(folded.out, HasSubstr("inverted    1: 1"));
  EXPECT_THAT(folded.out, Not(HasSubstr("overlap     none")));
  EXPECT_THAT(tool.content("ids.txt"), HasSubstr("\ninverted 1\n"));

  const Outcome renumbered = tool.run("check renumbered.mesh");
  EXPECT_EQ(renumbered.code, 4);
  EXPECT_THAT(renumbered.out, HasSubstr("ordered against their neighbours"));
}

TEST(Commands, StatsComparesTwoMeshes) {
  Tool tool;
  ASSERT_EQ(tool.run("generate ball --n 3 -o ball.mesh").code, 0);
  ASSERT_EQ(tool.run("generate cylinder --n 2 3 --twist 20 -o cylinder.mesh").code, 0);
  const Outcome outcome = tool.run("stats ball.mesh cylinder.mesh");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("ball.mesh"), HasSubstr("cylinder.mesh"), HasSubstr("540"), HasSubstr("216")));
  EXPECT_THAT(tool.run("stats -v ball.mesh").out, HasSubstr("dihedral angles of ball.mesh"));
}

TEST(Commands, GeneratesAFandisk) {
  Tool tool;
  ASSERT_EQ(tool.run("generate fandisk -o a.mesh").code, 0);
  ASSERT_EQ(tool.run("generate fandisk --n 6 6 4 --jitter 0 -o b.mesh").code, 0);
  EXPECT_EQ(hash_of(tool, "a.mesh"), hash_of(tool, "b.mesh"));
  ASSERT_EQ(tool.run("generate fandisk --n 2 3 1 --jitter 0.1 --seed 4 -o c.mesh").code, 0);
  EXPECT_THAT(tool.run("stats c.mesh").out, HasSubstr("108"));
  EXPECT_EQ(tool.run("generate fandisk --n 2 3 0 -o d.mesh").code, 1);
}

TEST(Commands, ConvertThereAndBackGivesTheSameMesh) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 3 3 3 --jitter 0.1 --regions 2 -o a.mesh").code, 0);
  for (const char* file : {"b.meshb", "b.vtk", "b.vtu", "b.msh", "b.node", "b.ovm"}) {
    const Outcome there = tool.run(std::string("convert a.mesh ") + file);
    ASSERT_EQ(there.code, 0) << file << there.err;
    ASSERT_EQ(tool.run(std::string("convert ") + file + " c.mesh").code, 0) << file;
    EXPECT_EQ(hash_of(tool, "a.mesh"), hash_of(tool, "c.mesh")) << file;
  }
  EXPECT_EQ(tool.run("convert a.mesh d.vtk --binary").code, 0);
  EXPECT_EQ(tool.run("convert a.mesh d.msh --variant 2.2").code, 0);
}

TEST(Commands, GenerateGivesTheSameFileEveryTime) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 5 6 7 --field bulk-shear --amplitude 0.1 -o a.mesh").code, 0);
  ASSERT_EQ(tool.run("generate cavity --n 5 6 7 --field bulk-shear --amplitude 0.1 -o b.mesh").code, 0);
  ASSERT_EQ(tool.run("generate cavity --n 5 6 7 --field bulk-shear --amplitude 0.1 --seed 9 -o c.mesh").code,
            0);
  EXPECT_EQ(tool.content("a.mesh"), tool.content("b.mesh"));
  EXPECT_NE(tool.content("a.mesh"), tool.content("c.mesh"));
  EXPECT_EQ(tool.run("generate box --n 2 2 2 --low -1 -1 -1 --high 1 2 3 -o d.mesh").code, 0);
}

TEST(Commands, SurfaceFilesAreImprovedAsSurfaces) {
  if (!kHasSurface) GTEST_SKIP() << "this is a build without OpenMesh";
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 4 4 4 --jitter 0.3 -o box.mesh").code, 0);
  ASSERT_EQ(tool.run("convert box.mesh -o box.stl").code, 0);
  const Outcome outcome = tool.run("box.stl -o better.ply --json report.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json report = json::parse(tool.content("report.json"));
  EXPECT_GT(report["after"]["min_angle"]["min"], report["before"]["min_angle"]["min"]);
  EXPECT_EQ(report["after"]["open_edges"], 0);
  EXPECT_NEAR(report["after"]["volume"].get<double>(), 1, 1e-6);  // STL rounds coordinates to 32 bits
  EXPECT_EQ(report["surface"]["mode"], "free");
  EXPECT_THAT(outcome.out, HasSubstr("angle min"));
  EXPECT_THAT(tool.files(), ElementsAre("better.ply", "box.mesh", "box.stl", "report.json"));
  const Outcome again = tool.run("better.ply -o same.off --min-angle 1 --json -");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_FALSE(json::parse(again.out)["result"]["changed"]);
}

TEST(Commands, FeaturesComeBackAsLabels) {
  if (!kHasSurface) GTEST_SKIP() << "this is a build without OpenMesh";
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 3 3 3 -o box.mesh").code, 0);
  ASSERT_EQ(tool.run("box.mesh -o plain.mesh --surface flat").code, 0);
  EXPECT_THAT(tool.content("plain.mesh"), Not(HasSubstr("Edges")));
  for (const char* name : {"out.mesh", "out.msh", "out.vtu", "out.ovm"}) {
    const Outcome outcome =
        tool.run(std::string("box.mesh -o ") + name + " --surface flat --label-features --json report.json");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_GE(json::parse(tool.content("report.json"))["output"]["edges"], 12) << name;
  }
  EXPECT_THAT(tool.content("out.mesh"), HasSubstr("Edges\n"));
  EXPECT_THAT(tool.content("out.msh"), AllOf(HasSubstr("\"feature\""), HasSubstr("\"corner\"")));
  ASSERT_EQ(tool.run("convert out.msh -o back.mesh").code, 0);
  EXPECT_EQ(hash_of(tool, "out.mesh"), hash_of(tool, "back.mesh"));
}

TEST(Commands, SurfaceFilesHaveTheirOwnGoalAndModes) {
  if (!kHasSurface) GTEST_SKIP() << "this is a build without OpenMesh";
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 3 3 3 --jitter 0.3 -o box.mesh").code, 0);
  ASSERT_EQ(tool.run("convert box.mesh -o box.off").code, 0);
  const std::string before = tool.content("box.off");
  EXPECT_EQ(tool.run("box.off -o box.off --surface frozen").code, 1);
  EXPECT_EQ(tool.run("box.off -o box.off --min-dihedral 20").code, 1);
  EXPECT_EQ(tool.run("box.mesh -o out.mesh --min-angle 20").code, 1);
  EXPECT_EQ(tool.content("box.off"), before) << "nothing may be written after a usage error";
  const Outcome missed = tool.run("box.off -o out.off --min-angle 59");
  EXPECT_EQ(missed.code, 3);
  EXPECT_THAT(missed.err, HasSubstr("59 degrees"));
  EXPECT_THAT(tool.files(), ElementsAre("box.mesh", "box.off", "out.off"));
}

}  // namespace
}  // namespace hfr::app::test
