// SPDX-License-Identifier: BSD-3-Clause
// Standard streams that are closed, full, or hold the mesh itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "Tool.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Streams : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(tool_.run("generate cavity --n 5 5 5 -o in.mesh").code, 0);
    ASSERT_EQ(tool_.run("in.mesh -o wanted.mesh").code, 0);
    wanted_ = tool_.content("wanted.mesh");
  }

  /// The code of an improving run with these arguments and redirections, which must write the mesh.
  int code_of(const std::string& rest) {
    tool_.write("out.mesh", "old");
    const Outcome outcome = tool_.shell("\"$TOOL\" in.mesh -o out.mesh " + rest);
    EXPECT_TRUE(tool_.content("out.mesh") == wanted_) << rest << "\n" << outcome.err;
    err_ = outcome.err;
    return outcome.code;
  }

  Tool tool_;
  std::string wanted_, err_;
};

TEST_F(Streams, LostErrorsCostExitCodeOneAndNoMesh) {
  for (const char* lost : {"2>&-", "2>/dev/full"}) {
    EXPECT_EQ(code_of(std::string("--progress ") + lost), 1) << lost;
    EXPECT_EQ(code_of(lost), 0) << "nothing was to be said there: " << lost;
  }
}

TEST_F(Streams, ALostTableCostsExitCodeOneAndNoMesh) {
  for (const char* lost : {">&-", ">/dev/full"}) {
    EXPECT_EQ(code_of(lost), 1) << lost;
    EXPECT_THAT(err_, HasSubstr("the standard output cannot be written"));
    EXPECT_EQ(std::count(err_.begin(), err_.end(), '\n'), 1) << err_;
    EXPECT_EQ(code_of(std::string("-q ") + lost), 0) << "nothing was to be said there: " << lost;
    EXPECT_EQ(code_of(std::string("--json - ") + lost), 1) << lost;
    EXPECT_EQ(code_of(std::string("--ids - ") + lost), 1) << lost;
    EXPECT_EQ(code_of(std::string("--progress 2>&- ") + lost), 1) << lost;
  }
}

TEST_F(Streams, TheReportOfALostTableHasTheExitCodeOfTheProcess) {
  EXPECT_EQ(code_of("--json report.json >/dev/full"), 1);
  EXPECT_EQ(json::parse(tool_.content("report.json"))["exit_code"], 1);
}

TEST_F(Streams, NoFileTakesThePlaceOfAClosedStream) {
  EXPECT_EQ(code_of("--progress --json report.json <&- >&- 2>&-"), 1);
  EXPECT_TRUE(json::parse(tool_.content("report.json"), nullptr, false).is_object());
  EXPECT_EQ(tool_.shell("\"$TOOL\" convert in.mesh copy.mesh <&- >&- 2>&-").code, 1);
  EXPECT_EQ(tool_.content("copy.mesh"), tool_.content("in.mesh"));
}

TEST_F(Streams, AReaderWhoGoesAwayCostsNoMesh) {
  // The reader opens the pipe and goes before the tool begins.
  const Outcome outcome = tool_.shell(
      "mkfifo pipe; (true < pipe) & exec 3> pipe; wait; "
      "\"$TOOL\" in.mesh -o out.mesh --progress >&3 2>&3; echo $? > code");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(tool_.content("code"), "1\n");
  EXPECT_TRUE(tool_.content("out.mesh") == wanted_);
  EXPECT_THAT(outcome.err, IsEmpty());
}

TEST_F(Streams, ACodeThatSaysMoreStays) {
  tool_.write("bad.mesh", kHopelessCells);
  EXPECT_EQ(tool_.shell("\"$TOOL\" check bad.mesh >/dev/full").code, 4);
  EXPECT_EQ(tool_.shell("\"$TOOL\" check bad.mesh 2>&-").code, 4);
  EXPECT_EQ(tool_.shell("\"$TOOL\" in.mesh -o out.mesh --min-dihedral 70 >/dev/full").code, 3);
  EXPECT_EQ(tool_.shell("\"$TOOL\" check missing.mesh 2>/dev/full").code, 2);
}

TEST_F(Streams, EveryCommandSaysThatItsTableIsLost) {
  for (const char* command : {"check in.mesh", "stats -v in.mesh", "convert in.mesh b.vtk",
                              "generate ball -o b.vtk", "devices", "--help", "--version", "improve --help"})
    EXPECT_EQ(tool_.shell(std::string("\"$TOOL\" ") + command + " >/dev/full").code, 1) << command;
}

TEST_F(Streams, AMeshComesAndGoesByThem) {
  const Outcome outcome = tool_.shell("\"$TOOL\" - -o - --format mesh < in.mesh > out.mesh");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(tool_.content("out.mesh") == wanted_);
  EXPECT_EQ(tool_
                .shell("cat in.mesh | \"$TOOL\" convert - - --format mesh --output-format vtu |"
                       "\"$TOOL\" convert - copy.mesh --format VTU -q")
                .code,
            0);
  EXPECT_EQ(tool_.content("copy.mesh"), tool_.content("in.mesh"));
  EXPECT_EQ(
      tool_.shell("\"$TOOL\" generate ball --n 2 -o - --format off | \"$TOOL\" - -o - --format off > b.off")
          .code,
      0);
  EXPECT_EQ(
      tool_.shell("\"$TOOL\" generate ball --n 2 -o - --format .msh | \"$TOOL\" check - --format msh").code,
      0);
  const Outcome stats = tool_.shell("\"$TOOL\" stats in.mesh - --format mesh --json - < wanted.mesh");
  EXPECT_EQ(json::parse(stats.out)["meshes"].size(), 2U);
}

TEST_F(Streams, AMeshOnAStreamNeedsAFormatOfOneFile) {
  const auto refused = [&](const std::string& arguments, const std::string& what) {
    const Outcome outcome = tool_.shell("\"$TOOL\" " + arguments + " < in.mesh");
    EXPECT_EQ(outcome.code, 1) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(what)) << arguments;
    EXPECT_THAT(outcome.out, IsEmpty()) << arguments;
  };
  refused("- -o out.mesh", "--format");
  refused("in.mesh -o -", "--format");
  refused("in.mesh -o - --format node", "several files");
  refused("in.mesh -o - --format xyz", "unknown file type 'xyz'");
  refused("in.mesh -o out.mesh --format mesh", "--format is for");
  refused("stats - - --format mesh", "cannot both be -");
  refused("in.mesh -o - --format mesh --json -", "cannot both be -");
  refused("check in.mesh --ids - --json -", "cannot both be -");
  refused("in.mesh -o - --format mesh --ids /dev/stdout", "cannot both be -");
  refused("in.mesh -o - --format mesh >&-", "closed");
  EXPECT_THAT(tool_.files(), ElementsAre("in.mesh", "wanted.mesh"));
}

TEST_F(Streams, APipeThatIsNamedIsRefusedAndNotWaitedFor) {
  tool_.limit_seconds(20);
  ASSERT_EQ(tool_.shell("mkfifo pipe.mesh").code, 0);
  for (const char* command : {"check pipe.mesh", "pipe.mesh -o out.mesh", "convert pipe.mesh out.vtk"}) {
    const Outcome outcome = tool_.run(command);
    EXPECT_EQ(outcome.code, 2) << command;
    EXPECT_EQ(outcome.err, "hfremesh: pipe.mesh: cannot be opened: Not a regular file\n");
  }
}

}  // namespace
}  // namespace hfr::app::test
