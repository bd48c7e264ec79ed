// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "Tool.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Every key of docs/json.md that a statistics object has.
constexpr const char* kStatisticsKeys[] = {"vertices",
                                           "unused_vertices",
                                           "cells",
                                           "edges",
                                           "faces",
                                           "boundary_faces",
                                           "interface_faces",
                                           "components",
                                           "inverted",
                                           "inverted_cells",
                                           "flat",
                                           "flat_cells",
                                           "min_dihedral",
                                           "worst_cell",
                                           "mean_dihedral",
                                           "max_dihedral",
                                           "dihedral_histogram",
                                           "min_dihedral_histogram",
                                           "cells_below",
                                           "volume_length",
                                           "volume_length_histogram",
                                           "edge_length",
                                           "box",
                                           "volume",
                                           "absolute_volume",
                                           "enclosed_volume",
                                           "overlap",
                                           "regions",
                                           "patches",
                                           "surface_ceiling",
                                           "interface_ceiling"};

void expect_keys(const json& object, std::initializer_list<const char*> keys) {
  for (const char* key : keys) EXPECT_TRUE(object.contains(key)) << key << " is missing";
}

TEST(Reports, JsonOfImproveHasEveryKey) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o out.mesh -j 2 --min-dihedral 12 --json out.json").code, 0);
  const json report = json::parse(tool.content("out.json"));
  expect_keys(report, {"schema", "tool", "command", "threads", "input", "options", "output", "seconds",
                       "result", "before", "after", "passes", "notes", "exit_code"});
  EXPECT_EQ(report["schema"], "hfremesh-1");
  EXPECT_EQ(report["command"], "improve");
  EXPECT_EQ(report["threads"], 2);
  EXPECT_EQ(report["exit_code"], 0);
  EXPECT_EQ(report["options"]["min_dihedral"], 12.0);
  expect_keys(report["input"], {"file", "flipped", "reoriented"});
  expect_keys(report["seconds"], {"read", "build", "improve", "statistics", "write"});
  expect_keys(report["output"], {"file", "vertices", "cells", "triangles", "edges", "hash"});
  expect_keys(report["result"],
              {"changed", "goal_reached", "stop", "n_invalid_cells", "invalid_cells", "n_large_stars"});
  ASSERT_FALSE(report["passes"].empty());
  for (const json& pass : report["passes"])
    expect_keys(pass, {"stage", "op", "iteration", "rounds", "sub_rounds", "seeds", "candidates", "winners",
                       "inverted", "worst", "seconds"});
  for (const char* key : kStatisticsKeys) {
    EXPECT_TRUE(report["before"].contains(key)) << key;
    EXPECT_TRUE(report["after"].contains(key)) << key;
  }
  EXPECT_GT(report["before"]["inverted"], 0);
  EXPECT_EQ(report["after"]["inverted"], 0);
  EXPECT_GE(report["after"]["min_dihedral"]["min"], 12.0);
}

TEST(Reports, ReasonsAreListedAndTheProofOfACeilingNamesItsEdge) {
  // A roof whose ridge, between vertices 1 and 2, leaves 20 degrees.
  Tool tool;
  tool.write("in.mesh",
             "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n-1 0 0 0\n1 0 0 0\n"
             "0 0.17364817766693033 0.98480775301220802 0\n0 -0.17364817766693033 0.98480775301220802 0\n"
             "0 0 3 0\nTetrahedra\n3\n1 2 3 4 0\n1 3 5 4 0\n2 5 3 4 0\nEnd\n");
  const Outcome outcome = tool.run("in.mesh -o out.mesh --min-dihedral 25 --json out.json");
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  const json limits = json::parse(tool.content("out.json"))["limits"];
  expect_keys(limits["counts"],
              {"folded surface", "surface ceiling", "input feature", "surface feature", "max cells",
               "time limit", "cancelled", "iterations", "device lost", "not found"});
  EXPECT_FALSE(limits["counts"].contains("frozen vertices"));
  EXPECT_FALSE(limits["counts"].contains("budget"));
  bool found = false;
  for (const json& cell : limits["cells"]) {
    expect_keys(cell, {"cell", "degrees", "limit", "frozen_vertices", "edge", "ceiling"});
    if (cell["limit"] != "surface ceiling") continue;
    found = true;
    EXPECT_EQ(cell["edge"], json({0, 1}));
    EXPECT_NEAR(cell["ceiling"], 20, 1e-9);
  }
  EXPECT_TRUE(found);
}

TEST(Reports, HashIsThatOfTheFile) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 6 6 6 -o in.mesh --json made.json").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o out.mesh --json out.json").code, 0);
  const json stats = json::parse(tool.run("stats in.mesh out.mesh --json -").out);
  EXPECT_EQ(json::parse(tool.content("made.json"))["output"]["hash"], stats["meshes"][0]["hash"]);
  EXPECT_EQ(json::parse(tool.content("out.json"))["output"]["hash"], stats["meshes"][1]["hash"]);
  EXPECT_NE(stats["meshes"][0]["hash"], stats["meshes"][1]["hash"]);
}

TEST(Reports, JsonOnStdoutIsAlone) {
  Tool tool;
  ASSERT_EQ(tool.run("generate ball --n 2 -o in.mesh").code, 0);
  for (const char* arguments :
       {"check in.mesh --json -", "stats in.mesh --json -", "convert in.mesh b.vtk --json -",
        "in.mesh -o out.mesh --json -", "generate box -o box.mesh --json -"}) {
    const Outcome outcome = tool.run(arguments);
    const json report = json::parse(outcome.out, nullptr, false);
    ASSERT_TRUE(report.is_object()) << arguments << "\n" << outcome.out;
    EXPECT_EQ(report["schema"], "hfremesh-1");
    EXPECT_EQ(report["exit_code"], outcome.code);
  }
}

TEST(Reports, JsonTellsOfFailures) {
  Tool tool;
  EXPECT_EQ(tool.run("check missing.mesh --json out.json").code, 2);
  const json report = json::parse(tool.content("out.json"));
  EXPECT_EQ(report["exit_code"], 2);
  EXPECT_THAT(report["error"].get<std::string>(), HasSubstr("missing.mesh"));
}

TEST(Reports, JsonOfCheckListsTheBadCells) {
  Tool tool;
  tool.write("in.mesh", kFoldedCells);
  EXPECT_EQ(tool.run("check in.mesh --json out.json").code, 4);
  const json report = json::parse(tool.content("out.json"));
  EXPECT_EQ(report["result"]["valid"], false);
  EXPECT_EQ(report["result"]["overlaps"], true);
  EXPECT_EQ(report["statistics"]["inverted_cells"], json::array({1}));
}

TEST(Reports, TableStandsBeforeAndAfterSideBySide) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  const Outcome outcome = tool.run("in.mesh -o out.mesh");
  for (const char* row : {"before", "after", "cells", "vertices", "inverted", "flat", "dihedral min",
                          "dihedral max", "p0.1", "p1", "p5", "volume", "overlap", "seconds"})
    EXPECT_THAT(outcome.out, HasSubstr(row));
  EXPECT_THAT(tool.run("in.mesh -o out.mesh -v").out, HasSubstr("candidates"));
}

TEST(Reports, QuietPrintsNothing) {
  Tool tool;
  tool.write("in.mesh", kFlippedCells);
  const Outcome outcome = tool.run("in.mesh -o out.mesh -q");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(tool.run("in.mesh -o out.mesh").err, HasSubstr("hfremesh: note: "));
}

TEST(Reports, NothingInAPipeSteersATerminal) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  for (const char* arguments :
       {"in.mesh -o out.mesh", "in.mesh -o out.mesh --progress -v", "check in.mesh"}) {
    const Outcome outcome = tool.run(arguments);
    for (const std::string& text : {outcome.out, outcome.err})
      for (const char c : text) ASSERT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20) << arguments;
  }
}

TEST(Reports, ProgressIsSilentUnlessAskedFor) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  EXPECT_THAT(tool.run("in.mesh -o out.mesh").err, IsEmpty());
  EXPECT_THAT(tool.run("in.mesh -o out.mesh --progress").err, HasSubstr("hfremesh: progress: "));
}

TEST(Reports, FileNamesCannotSteerATerminal) {
  Tool tool;
  const Outcome outcome = tool.shell("\"$TOOL\" check \"$(printf 'a\\033[31m.mesh')\"");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, Not(HasSubstr("\033")));
}

TEST(Reports, CoarsenLeavesFewerCells) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 8 8 8 --jitter 0.3 -o in.mesh").code, 0);
  const auto cells_with = [&](const std::string& option, bool coarsen) {
    EXPECT_EQ(tool.run("in.mesh -o out.mesh --json r.json " + option).code, 0);
    const json report = json::parse(tool.content("r.json"));
    EXPECT_EQ(report["options"]["coarsen"], coarsen);
    return report["after"]["cells"].get<int>();
  };
  EXPECT_LT(cells_with("--coarsen", true), cells_with("", false));
}

}  // namespace
}  // namespace hfr::app::test
