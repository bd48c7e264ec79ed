// SPDX-License-Identifier: BSD-3-Clause
// What is known of files before any is read, links, and what a signal leaves behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "Tool.hh"

namespace hfr::app::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The input is missing, so a message about anything else has come before it was looked for.
void expect_refused_unread(Tool& tool, const std::string& arguments, const std::string& what) {
  const auto before = tool.files();
  const Outcome outcome = tool.run(arguments);
  EXPECT_EQ(outcome.code, 1) << arguments << "\n" << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(what)) << arguments;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_EQ(tool.files(), before) << arguments;
}

TEST(Paths, OutputsAreLookedAtBeforeTheInput) {
  Tool tool;
  const std::string too_long(250, 'n');
  fs::create_directory(tool.path("folder.vtk"));
  expect_refused_unread(tool, "missing.mesh -o out.vtu --variant bogus", "unknown variant 'bogus'");
  expect_refused_unread(tool, "missing.mesh -o out.mesh --variant 4.1", "which has none");
  expect_refused_unread(tool, "convert missing.mesh out.msh --variant zlib", "known are 2.2 4.0 4.1");
  expect_refused_unread(tool, "missing.mesh -o out.xyz", "unknown file type");
  expect_refused_unread(tool, "missing.mesh -o " + too_long + "n.mesh", "File name too long");
  expect_refused_unread(tool, "missing.mesh -o folder.vtk", "it is a folder");
  expect_refused_unread(tool, "missing.mesh -o nowhere/out.vtk", "no folder nowhere");
  expect_refused_unread(tool, "missing.mesh -o out.vtk --json nowhere/x", "no folder nowhere");
  expect_refused_unread(tool, "missing.mesh -o out.vtk --ids folder.vtk", "it is a folder");
  expect_refused_unread(tool, "check missing.mesh --ids " + too_long + "nnnnnn", "File name too long");
}

TEST(Paths, TheLongestNameIsWritten) {
  Tool tool;
  const std::string name = std::string(250, 'n') + ".mesh";
  EXPECT_EQ(tool.run("generate box --n 1 1 1 -o " + name).code, 0);
  EXPECT_THAT(tool.files(), ElementsAre(name));
}

TEST(Paths, AFileThatMayNotBeWrittenIsLookedAtBeforeTheInput) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  Tool tool;
  tool.write("out.mesh", "old");
  fs::permissions(tool.path("out.mesh"), fs::perms::owner_read);
  expect_refused_unread(tool, "missing.mesh -o out.mesh", "Permission denied");
}

TEST(Paths, NoReportTakesThePlaceOfAMeshOrOfAnotherReport) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  tool.write("old.mesh", "old");
  tool.write("in.node", "old");
  fs::create_symlink("in.mesh", tool.path("link.mesh"));
  fs::create_hard_link(tool.path("in.mesh"), tool.path("twin"));
  fs::create_directory(tool.path("below"));
  fs::create_symlink("new.mesh", tool.path("dangling"));
  for (const char* arguments :
       {"in.mesh -o new.mesh --json new.mesh", "in.mesh -o new.mesh --json ./below/../new.mesh",
        "in.mesh -o old.mesh --json old.mesh", "in.mesh -o new.mesh --ids new.mesh",
        "in.mesh -o new.mesh --json in.mesh", "in.mesh -o new.mesh --json twin",
        "link.mesh -o new.mesh --ids in.mesh", "in.mesh -o new.mesh --json dangling",
        "in.mesh -o new.mesh --ids x --json x", "check in.mesh --ids in.mesh", "check in.mesh --json twin",
        "stats in.mesh old.mesh --json old.mesh", "convert in.mesh new.vtk --json new.vtk",
        "convert in.mesh in.ele --json in.node", "generate ball -o new.mesh --json new.mesh",
        "in.mesh --dry-run --json in.mesh"})
    expect_refused_unread(tool, arguments, "are the same file");
  EXPECT_EQ(tool.content("in.mesh"), kTwoCells);
  EXPECT_EQ(tool.shell("\"$TOOL\" in.mesh -o old.mesh >> old.mesh").code, 1);
  EXPECT_EQ(tool.content("old.mesh"), "old");
  EXPECT_EQ(tool.run("in.mesh -o in.mesh --json /dev/null --ids /dev/null -q").code, 0)
      << "in place, and nowhere";
}

TEST(Paths, ALinkToNothingIsFollowedAndOneToItselfRefused) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  fs::create_symlink("real.mesh", tool.path("link.mesh"));
  fs::create_symlink("loop.mesh", tool.path("loop.mesh"));
  EXPECT_EQ(tool.run("in.mesh -o link.mesh").code, 0);
  EXPECT_TRUE(fs::is_symlink(tool.path("link.mesh")));
  EXPECT_TRUE(fs::is_regular_file(tool.path("real.mesh")));
  expect_refused_unread(tool, "missing.mesh -o loop.mesh", "Too many levels of symbolic links");
  EXPECT_TRUE(fs::is_symlink(tool.path("loop.mesh")));
}

TEST(Paths, OtherNamesOfTheOutputAreSaidToKeepTheOldFile) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  fs::create_hard_link(tool.path("in.mesh"), tool.path("twin.mesh"));
  for (const char* command :
       {"in.mesh -o in.mesh", "convert in.mesh twin.mesh", "generate ball --n 1 -o twin.mesh"}) {
    EXPECT_THAT(tool.run(command).err, HasSubstr("other names (hard links), which keep the old file"))
        << command;
    fs::remove(tool.path("twin.mesh"));
    fs::create_hard_link(tool.path("in.mesh"), tool.path("twin.mesh"));
  }
  fs::remove(tool.path("twin.mesh"));
  EXPECT_THAT(tool.run("in.mesh -o in.mesh").err, IsEmpty());
}

class SignalledWhileWriting : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { ASSERT_EQ(tool_.run("generate cavity --n 20 20 20 -o in.mesh").code, 0); }

  /// Whether a temporary file of more than so many bytes is there.
  bool has_temporary(std::uintmax_t size) const {
    const auto files = tool_.files();
    return std::any_of(files.begin(), files.end(), [&](const std::string& f) {
      std::error_code gone;
      const std::uintmax_t length = f.ends_with(".tmp") ? fs::file_size(tool_.path(f), gone) : 0;
      return f.ends_with(".tmp") && !gone && length >= size;
    });
  }

  /// Waits until a part of the mesh is written; false when the program ends before that is seen.
  bool wait_for_temporary(pid_t child) const {
    siginfo_t info{};
    while (waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == 0)
      if (has_temporary(1)) return true;
    return false;
  }

  /// Sends the signal while the mesh is being written, several times; how often the program was there.
  int end_while_writing(const std::string& arguments, int first_signal) {
    int n_ended = 0;
    for (int run = 0; run < 3; ++run) {
      const pid_t child = tool_.start(arguments);
      if (first_signal != 0) {
        while (tool_.err_so_far().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        kill(child, first_signal);
      }
      wait_for_temporary(child);
      kill(child, GetParam());
      const int code = tool_.finish(child).code;
      n_ended += code == 128 + GetParam() ? 1 : 0;
      EXPECT_FALSE(has_temporary(0)) << arguments << ": " << code;
      const std::string out = tool_.content("out.vtk");
      EXPECT_TRUE(out.empty() || tool_.run("stats out.vtk").code == 0) << code << ": half a file";
      fs::remove(tool_.path("out.vtk"));
    }
    return n_ended;
  }

  Tool tool_;
};

INSTANTIATE_TEST_SUITE_P(All, SignalledWhileWriting, testing::Values(SIGTERM, SIGHUP));

TEST_P(SignalledWhileWriting, ConvertLeavesNoTemporaryFile) {
  EXPECT_GT(end_while_writing("convert in.mesh out.vtk", 0), 0) << "no signal came in time";
}

TEST_P(SignalledWhileWriting, GenerateLeavesNoTemporaryFile) {
  EXPECT_GT(end_while_writing("generate box --n 25 25 25 -o out.vtk", 0), 0) << "no signal came in time";
}

TEST_P(SignalledWhileWriting, ASecondSignalToImproveLeavesNoTemporaryFile) {
  EXPECT_GT(end_while_writing("in.mesh -o out.vtk --progress --iterations 1", SIGTERM), 0)
      << "no signal came in time";
}

TEST(Signals, TheFirstOneEndsARunThatStillReads) {
  Tool tool;
  tool.limit_seconds(20);
  const Outcome outcome = tool.shell(
      "mkfifo pipe; \"$TOOL\" - -o out.mesh --format mesh < pipe & tool=$!; exec 3> pipe; sleep 0.3;"
      "kill -TERM $tool; wait $tool");
  EXPECT_EQ(outcome.code, 128 + SIGTERM) << outcome.err;
}

}  // namespace
}  // namespace hfr::app::test
