// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <new>
#include <thread>

#include "ExitCode.hh"
#include "Tool.hh"
#include "hfremesh/HalfFace/Errors.hh"

namespace hfr::app::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// A failure says so in one line, leaves nothing on stdout and no file that was not there.
void expect_failure(Tool& tool, const std::string& arguments, int code, const std::string& what) {
  const auto before = tool.files();
  const Outcome outcome = tool.run(arguments);
  EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
  EXPECT_THAT(outcome.err, StartsWith("hfremesh: "));
  EXPECT_THAT(outcome.err, HasSubstr(what)) << arguments;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(tool.files(), before) << arguments;
}

TEST(ExitCodes, ZeroWhenEveryGoalIsMet) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  const Outcome outcome = tool.run("in.mesh -o out.mesh");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(tool.run("check out.mesh").code, 0);
  EXPECT_THAT(tool.files(), ElementsAre("in.mesh", "out.mesh"));
}

TEST(ExitCodes, ZeroWhenAFoldIsOpened) {
  Tool tool;
  tool.write("in.mesh", kFoldedCells);
  EXPECT_EQ(tool.run("in.mesh -o out.mesh").code, 0);
  EXPECT_EQ(tool.run("check out.mesh").code, 0);
}

TEST(ExitCodes, OneForACommandLineThatIsWrong) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  expect_failure(tool, "", 1, "--help");
  expect_failure(tool, "improve", 1, "IN is required");
  expect_failure(tool, "in.mesh", 1, "-o FILE is required");
  expect_failure(tool, "in.mesh -o out.mesh --no-such-option", 1, "--no-such-option");
  expect_failure(tool, "in.mesh -o out.mesh --min-dihedral 80", 1, "dihedral");
  expect_failure(tool, "in.mesh -o out.mesh --min-dihedral wide", 1, "--min-dihedral");
  expect_failure(tool, "in.mesh -o out.mesh --iterations -1", 1, "--iterations");
  expect_failure(tool, "in.mesh -o out.mesh --time-limit 0", 1, "--time-limit");
  expect_failure(tool, "in.mesh -o out.mesh --ops edge,polish", 1, "polish");
  expect_failure(tool, "in.mesh -o out.mesh --metric beauty", 1, "beauty");
  expect_failure(tool, "in.mesh -o out.mesh --compat 2014", 1, "--compat");
  expect_failure(tool, "in.mesh -o out.mesh -j -2", 1, "--threads");
  expect_failure(tool, "in.mesh -o out.mesh -q -v", 1, "--verbose");
  expect_failure(tool, "generate", 1, "--help");
  expect_failure(tool, "generate torus -o out.mesh", 1, "--help");
  expect_failure(tool, "generate box --n 0 1 1 -o out.mesh", 1, "at least one cube");
  expect_failure(tool, "generate box --n 1 1 -o out.mesh", 1, "--n");
  expect_failure(tool, "convert in.mesh out.vtu --variant morse", 1, "morse");
}

#ifdef HFR_HAS_SURFACE
TEST(ExitCodes, OneForPeriodicPatchesThatDoNotMatch) {
  Tool tool;
  // A cell over each of two triangles that are labelled 1 and 2; one is moved by (0, 0, 3), the other turned.
  const auto mesh_with = [](const char* last) {
    return std::string(
               "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n0 1 0 0\n"
               "0.3 0.3 1 0\n0 0 3 0\n1 0 3 0\n") +
           last +
           " 3 0\n0.3 0.3 2 0\nTetrahedra\n2\n1 2 3 4 0\n5 7 6 8 0\nTriangles\n2\n1 3 2 1\n5 6 7 2\nEnd\n";
  };
  tool.write("in.mesh", mesh_with("0 1"));
  EXPECT_EQ(tool.run("in.mesh -o out.mesh --surface flat --periodic 1:2").code, 0);
  tool.write("other.mesh", mesh_with("0.1 1"));
  expect_failure(tool, "other.mesh -o b.mesh --surface flat --periodic 1:2", 1,
                 "periodic patches 1 and 2 do not match: ");
  expect_failure(tool, "in.mesh -o b.mesh --surface flat --periodic 1:5", 1, "periodic patch 5 has no faces");
  expect_failure(tool, "in.mesh -o b.mesh --surface flat --periodic 1", 1, "--periodic takes A:B");
}
#endif

TEST(ExitCodes, OneForAnOutputThatCannotBeWritten) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  std::filesystem::create_directory(tool.path("folder.mesh"));
  expect_failure(tool, "in.mesh -o out.xyz", 1, "unknown file type '.xyz'");
  expect_failure(tool, "in.mesh -o out", 1, "unknown file type ''");
  expect_failure(tool, "in.mesh -o nowhere/out.mesh", 1, "there is no folder nowhere");
  expect_failure(tool, "in.mesh -o folder.mesh", 1, "it is a folder");
  expect_failure(tool, "convert in.mesh nowhere/out.mesh", 1, "there is no folder nowhere");
  expect_failure(tool, "generate ball -o nowhere/out.mesh", 1, "there is no folder nowhere");
  expect_failure(tool, "in.mesh -o out.mesh --json nowhere/out.json", 1, "there is no folder nowhere");
  expect_failure(tool, "check in.mesh --ids nowhere/ids", 1, "there is no folder nowhere");
}

TEST(ExitCodes, OneForAFolderThatTakesNoFiles) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  std::filesystem::create_directory(tool.path("locked"));
  std::filesystem::permissions(tool.path("locked"), std::filesystem::perms::owner_read);
  expect_failure(tool, "in.mesh -o locked/out.mesh", 1, "Permission denied");
}

TEST(ExitCodes, TwoForAnInputThatCannotBeRead) {
  Tool tool;
  tool.write("empty.mesh", "");
  tool.write("cut.mesh", std::string(kTwoCells).substr(0, 115));
  tool.write("noise.mesh", std::string("\x7f\0\x01\xff noise", 10));
  tool.write("range.mesh",
             std::string(kTwoCells).replace(std::string(kTwoCells).find("1 3 2 5"), 7, "1 3 2 9"));
  tool.write("nan.mesh", std::string(kTwoCells).replace(std::string(kTwoCells).find("0 0 -1"), 6, "0 nan 0"));
  tool.write("three.mesh",
             "MeshVersionFormatted 2\nDimension 3\nVertices\n6\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 -1 "
             "0\n0 0 -2 0\n"
             "Tetrahedra\n3\n1 2 3 4 0\n1 3 2 5 0\n1 3 2 6 0\nEnd\n");
  tool.write("flat.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nEnd\n");
  tool.write("mesh.xyz", kTwoCells);
  const std::vector<std::pair<std::string, std::string>> inputs = {
      {"missing.mesh", "missing.mesh"}, {"empty.mesh", "empty"},        {"cut.mesh", "cut.mesh"},
      {"noise.mesh", "noise.mesh"},     {"range.mesh", "range.mesh"},   {"nan.mesh", "nan.mesh"},
      {"three.mesh", "more than two"},  {"flat.mesh", "no tetrahedra"}, {"mesh.xyz", "unknown file type"}};
  for (const auto& [file, what] : inputs) {
    expect_failure(tool, file + " -o out.mesh", 2, what);
    expect_failure(tool, "check " + file, 2, what);
    expect_failure(tool, "stats " + file, 2, what);
    // What no mesh can be built from may still be converted.
    if (file != "three.mesh" && file != "flat.mesh")
      expect_failure(tool, "convert " + file + " out.vtk", 2, what);
  }
}

TEST(ExitCodes, ThreeWhenAValidMeshMissesTheGoal) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  const Outcome outcome = tool.run("in.mesh -o out.mesh --min-dihedral 70");
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("the goal of 70 degrees was not reached"));
  EXPECT_EQ(tool.run("check out.mesh").code, 0);
  EXPECT_EQ(tool.run("check out.mesh --min-dihedral 70").code, 3);
  EXPECT_EQ(tool.run("check out.mesh --min-dihedral 10").code, 0);
}

TEST(ExitCodes, FourWhenInvalidCellsRemainAndTheyAreNamed) {
  Tool tool;
  tool.write("in.mesh", kHopelessCells);
  const Outcome outcome = tool.run("in.mesh -o out.mesh");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("1 inverted or flat cells remain: 1"));
  EXPECT_THAT(tool.files(), ElementsAre("in.mesh", "out.mesh"));
  EXPECT_EQ(tool.run("check out.mesh").code, 4);
}

#ifdef HFR_HAS_SURFACE
// The commands of docs/surface.md.
TEST(ExitCodes, FourForASideThatIsFoldedOverAndZeroOnceTheSurfaceIsFree) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cylinder --n 6 16 --wring 90 -o c.mesh").code, 0);
  const Outcome frozen = tool.run("c.mesh -o frozen.mesh");
  EXPECT_EQ(frozen.code, 4) << frozen.err;
  EXPECT_THAT(frozen.err, HasSubstr("boundary faces every mesh with this boundary has such a cell"));
  const Outcome free = tool.run("c.mesh -o free.mesh --surface free --hausdorff 0.03");
  EXPECT_EQ(free.code, 0) << free.err;
  EXPECT_EQ(tool.run("check free.mesh").code, 0);
}
#endif

TEST(ExitCodes, FiveWhenTheTimeIsUpAndTheMeshIsWritten) {
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  const Outcome outcome = tool.run("in.mesh -o out.mesh --time-limit 1e-6");
  EXPECT_EQ(outcome.code, 5) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("time limit"));
  EXPECT_THAT(tool.files(), ElementsAre("in.mesh", "out.mesh"));
  EXPECT_EQ(tool.run("stats out.mesh").code, 0);
}

/// Runs whose address space is limited.
class LittleMemory : public ::testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers need more address space than the limit leaves";
#endif
  }
};

TEST_F(LittleMemory, FiveForMoreMemoryThanThereIs) {
  Tool tool;
  const Outcome outcome = tool.shell("ulimit -v 400000; \"$TOOL\" generate box --n 300 300 300 -o out.mesh");
  EXPECT_EQ(outcome.code, 5) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("not enough memory"));
  EXPECT_THAT(tool.files(), IsEmpty());
}

TEST_F(LittleMemory, FiveForAFileThatMemoryDoesNotHold) {
  Tool tool;
  const Outcome outcome = tool.shell("truncate -s 1G in.vtu; ulimit -v 400000; \"$TOOL\" in.vtu -o out.mesh");
  EXPECT_EQ(outcome.code, 5) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("in.vtu: not enough memory"));
  EXPECT_THAT(tool.files(), ElementsAre("in.vtu"));
}

TEST_F(LittleMemory, NoTemporaryFileStaysHoweverLittleMemoryThereIs) {
  Tool tool;
  tool.shell("\"$TOOL\" generate box --n 2 2 2 -o in.vtu");
  tool.shell("for k in $(seq 12000 250 40000); do (ulimit -v $k; \"$TOOL\" in.vtu -o out.vtu -q -j 1); done");
  EXPECT_THAT(tool.files(), ElementsAre("in.vtu", "out.vtu")) << "or the limits are too low for any run";
}

TEST(ExitCodes, FiveForMoreCellsThanAnIndexCounts) {
  Tool tool;
  const Outcome outcome = tool.run("generate ball --n 4000 -o out.mesh");
#ifdef HFR_INDEX64
  EXPECT_EQ(outcome.code, 5) << outcome.err;  // the memory will not do either
#else
  EXPECT_EQ(outcome.code, 5) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("too large for the indices"));
#endif
}

TEST(ExitCodes, SixSevenAndTheRestFollowTheKindOfError) {
  EXPECT_EQ(exit_code_of(DeviceError("no device")), ExitCode::kDevice);
  EXPECT_EQ(exit_code_of(std::logic_error("a bug")), ExitCode::kInternal);
  EXPECT_EQ(exit_code_of(std::bad_alloc()), ExitCode::kLimit);
  EXPECT_EQ(exit_code_of(std::length_error("vector")), ExitCode::kLimit);
  EXPECT_EQ(exit_code_of(ResourceLimit("too many")), ExitCode::kLimit);
  EXPECT_EQ(exit_code_of(InvalidInput("a goal out of range")), ExitCode::kUsage);
  EXPECT_EQ(exit_code_of(Failure(ExitCode::kCannotRead, "gone")), ExitCode::kCannotRead);
  EXPECT_THAT(message_of(std::bad_alloc()), HasSubstr("not enough memory"));
}

TEST(ExitCodes, HundredAndThirtyWhenCancelledAndTheBestMeshIsWritten) {
  for (const int signal : {SIGINT, SIGTERM}) {
    Tool tool;
    ASSERT_EQ(tool.run("generate cavity --n 26 26 26 -o in.mesh").code, 0);
    const pid_t child = tool.start("in.mesh -o out.mesh --progress --json out.json");
    // The first line of progress says that the run is past reading; much is still to be done then.
    for (int wait = 0; wait < 60000 && tool.err_so_far().empty(); ++wait)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, signal);
    const Outcome outcome = tool.finish(child);
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("cancelled"));
    EXPECT_THAT(tool.files(), ElementsAre("in.mesh", "out.json", "out.mesh"));
    EXPECT_EQ(tool.run("stats out.mesh").code, 0);
    EXPECT_THAT(tool.content("out.json"), HasSubstr("\"exit_code\": 130"));
  }
}

}  // namespace
}  // namespace hfr::app::test
