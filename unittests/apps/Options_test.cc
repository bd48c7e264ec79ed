// SPDX-License-Identifier: BSD-3-Clause
// Options that are out of range, name what is not there, or count for nothing; and limits of the machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "Tool.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

void expect_refused(Tool& tool, const std::string& arguments, const std::string& option) {
  const auto before = tool.files();
  const Outcome outcome = tool.run(arguments);
  EXPECT_EQ(outcome.code, 1) << arguments << "\n" << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(option)) << arguments;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_LT(outcome.err.size(), 400U) << outcome.err;
  EXPECT_EQ(tool.files(), before) << arguments;
}

TEST(Options, NumbersThatAreNoneAreRefusedEverywhere) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  const std::string long_number(310, '9');
  const std::vector<std::pair<std::string, std::vector<std::string>>> reals = {
      {"in.mesh -o out.mesh",
       {"--min-dihedral", "--min-angle", "--time-limit", "--hausdorff", "--feature-angle"}},
      {"check in.mesh", {"--min-dihedral"}},
      {"generate cavity -o out.mesh", {"--jitter", "--sigma", "--amplitude"}},
      {"generate box -o out.mesh", {"--jitter", "--low 0 0", "--high 1 1"}},
      {"generate ball -o out.mesh", {"--jitter", "--radius"}},
      {"generate cylinder -o out.mesh", {"--jitter", "--radius", "--height", "--twist", "--wring"}},
      {"generate fandisk -o out.mesh", {"--jitter"}}};
  for (const auto& [command, options] : reals)
    for (const std::string& option : options)
      for (const std::string& value :
           {std::string("nan"), std::string("inf"), std::string("-inf"), std::string("1e400"),
            std::string("1e5000"), std::string("1x"), long_number})
        expect_refused(tool, command + " " + option + " " + value, option.substr(0, option.find(' ')));
  const std::vector<std::pair<std::string, std::vector<std::string>>> integers = {
      {"in.mesh -o out.mesh",
       {"--seed", "--iterations", "--min-cells", "--max-cells", "--work-group", "--png-width", "-j"}},
      {"generate cavity -o out.mesh", {"--seed", "--n 1 1"}},
      {"generate box -o out.mesh", {"--seed", "--regions", "--n 1 1"}},
      {"generate ball -o out.mesh", {"--seed", "--n"}},
      {"generate cylinder -o out.mesh", {"--seed", "--n 1"}},
      {"generate fandisk -o out.mesh", {"--seed", "--n 1 1"}}};
  for (const auto& [command, options] : integers)
    for (const std::string& option : options)
      for (const std::string& value :
           {std::string("-1"), std::string("1.5"), std::string("nan"), std::string("0x"), long_number})
        expect_refused(tool, command + " " + option + " " + value,
                       option == "-j" ? "--threads" : option.substr(0, option.find(' ')));
  expect_refused(tool, "in.mesh -o out.mesh -j 100000", "--threads");
  expect_refused(tool, "in.mesh -o out.mesh --min-dihedral 70.5", "between 0 and 70.5");
  expect_refused(tool, "in.mesh -o out.mesh --hausdorff -1", "a number from 0 on is wanted, not '-1'");
  expect_refused(tool, "in.mesh -o out.mesh --time-limit -1", "a number above 0 is wanted, not '-1'");
}

TEST(Options, NamesThatThereAreNotAreRefusedWithThoseThatThereAre) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  expect_refused(tool, "in.mesh -o out.mesh --surface soft", "soft not in {frozen,flat,free}");
  expect_refused(tool, "in.mesh -o out.mesh --work-group 3", "3 not in {0,1,2,4,");
  expect_refused(tool, "generate cavity -o out.mesh --field 1", "1 not in {gaussians,bulk-shear}");
}

TEST(Options, TheLargestSeedIsTaken) {
  Tool tool;
  EXPECT_EQ(tool.run("generate box --n 1 1 1 --seed 18446744073709551615 -o out.mesh").code, 0);
  EXPECT_EQ(tool.run("out.mesh -o out.mesh --seed 18446744073709551615").code, 0);
}

TEST(Options, WhatIsToBeFixedMustBeThere) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 2 2 2 -o in.mesh").code, 0);
  for (const char* mode : {"", " --surface flat"}) {
    const auto refused = [&](const std::string& what, const std::string& why) {
      expect_refused(tool, "in.mesh -o out.mesh --fix " + what + mode, why);
    };
    refused("vertex:99999999", "--fix vertex:99999999: there are 27 vertices");
    refused("vertex:27", "--fix vertex:27");
    refused("vertex:99999999999", "--fix takes");
    refused("vertex:-1", "--fix takes");
    refused("edge:0-26000", "--fix edge:0-26000");
    refused("edge:0-2", "there is no such edge");
    refused("face:0-1-26", "there is no such face");
    refused("patch:3", "no triangle has this label");
    refused("patch:99999999999", "--fix takes");
  }
}

TEST(Options, ThoseThatCountForNothingAreNamed) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 2 2 2 -o in.mesh").code, 0);
  const std::vector<std::pair<std::string, std::string>> idle = {
      {"--hausdorff 0.1", "--hausdorff counts only with --surface free"},
      {"--feature-angle 30", "--feature-angle counts only with --surface free"},
      {"--hybrid", "--hybrid counts only with --device"},
      {"--compat jpdc2013 --surface free", "--surface does nothing with --compat"},
      {"--compat jpdc2013 --smoother taubin", "--smoother does nothing with --compat"},
      {"--compat jpdc2013 --min-dihedral 5", "--min-dihedral is not worked for with --compat"},
      {"--compat jpdc2013 --passes-only", "--passes-only does nothing with --compat"},
      {"--polish-only --min-dihedral 5 --metric volume-length", "--metric does nothing with --polish-only"},
      {"--polish-only --min-dihedral 5 --passes-only", "--passes-only does nothing with --polish-only"}};
  for (const auto& [option, note] : idle) {
    const Outcome outcome = tool.run("in.mesh -o out.mesh " + option);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(note));
  }
  EXPECT_THAT(tool.run("in.mesh -o out.mesh --fix vertex:13").err, Not(HasSubstr("counts only")));
}

#ifdef HFR_HAS_SURFACE
TEST(Options, ThoseOfCellsAreNamedOrRefusedForASurface) {
  Tool tool;
  ASSERT_EQ(tool.run("generate box --n 3 3 3 -o in.stl").code, 0);
  EXPECT_THAT(tool.run("in.stl -o out.stl --max-cells 5").err,
              HasSubstr("--max-cells does nothing with a surface without cells"));
  const Outcome refused = tool.run("in.stl -o again.stl --ids ids.txt");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("--ids"));
  EXPECT_FALSE(std::filesystem::exists(tool.path("again.stl")));
}
#endif

TEST(Limits, ThreadsThatCannotBeMadeAreDoneWithout) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than the limit leaves";
#endif
  Tool tool;
  ASSERT_EQ(tool.run("generate cavity --n 8 8 8 -o in.mesh").code, 0);
  ASSERT_EQ(tool.run("in.mesh -o wanted.mesh").code, 0);
  const Outcome outcome =
      tool.shell("ulimit -s 8192; ulimit -v 800000; \"$TOOL\" in.mesh -o out.mesh -j 300 --json report.json");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("300 threads cannot be made here"));
  EXPECT_TRUE(tool.content("out.mesh") == tool.content("wanted.mesh"));
  const json report = json::parse(tool.content("report.json"));
  EXPECT_LT(report["threads"], 300);
  EXPECT_THAT(report["notes"].dump(), HasSubstr("300 threads"));
}

TEST(Limits, AMeshThatNoMemoryIsThereForIsNotBegun) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than the limit leaves";
#endif
  Tool tool;
  for (const char* shape : {"fandisk --n 1000000 1 1", "box --n 1000000 3 1", "cavity --n 3000000 1 1",
                            "ball --n 97", "cylinder --n 100 100", "cylinder --n 1000 1 --jitter 0.1"}) {
    const Outcome outcome =
        tool.shell(std::string("ulimit -v 300000; \"$TOOL\" generate ") + shape + " -o out.mesh");
    EXPECT_EQ(outcome.code, 5) << shape << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("not enough memory: a mesh of 18,"), HasSubstr("GiB"))) << shape;
    EXPECT_THAT(tool.files(), IsEmpty());
  }
}

TEST(Limits, CountsThatWrapRoundAreRefused) {
  Tool tool;
  for (const char* shape : {"fandisk --n 1 2147483649 1", "fandisk --n 1 1 2147483649",
                            "box --n 4294967295 1 1", "cylinder --n 65536 1"}) {
    const Outcome outcome = tool.run(std::string("generate ") + shape + " -o out.mesh");
    EXPECT_EQ(outcome.code, 5) << shape << outcome.err;
    EXPECT_THAT(tool.files(), IsEmpty());
  }
}

TEST(Options, WholeNumbersAreDecimal) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  for (const char* arguments :
       {"generate box --n 010 010 010 -o a.mesh", "in.mesh -o a.mesh --max-cells 0100",
        "in.mesh -o a.mesh -j 010", "in.mesh -o a.mesh --seed 08"})
    expect_refused(tool, arguments, "a whole number");
}

TEST(Options, OneThatRepeatsLeavesTheNextWordAlone) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  const Outcome outcome = tool.run("--fix vertex:0 in.mesh -o a.mesh");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(tool.run("in.mesh -o a.mesh --fix vertex:0,vertex:1 --fix edge:0-1").code, 0);
}

TEST(Options, PlanIsPrintedWhereverTheMeshWouldGo) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  EXPECT_EQ(tool.run("in.mesh -o - --format mesh --plan").out, tool.run("in.mesh --plan").out);
  EXPECT_THAT(tool.run("in.mesh --plan").out, HasSubstr("polish"));
}

TEST(Options, WhatDoesNothingForASurfaceIsNamed) {
  Tool tool;
  tool.write("s.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Outcome outcome = tool.run(
      "s.off -o s2.off --surface flat --metric mean-ratio --ops edge --smoother taubin --rounds mixed "
      "--bulk-nodes "
      "--polish-only --passes-only --label-features --seed 5 --compat jpdc2013");
  if (outcome.code == 1) GTEST_SKIP() << outcome.err;
  for (const char* option : {"--metric", "--ops", "--smoother", "--rounds", "--bulk-nodes", "--polish-only",
                             "--passes-only", "--label-features", "--seed", "--compat"})
    EXPECT_THAT(outcome.err, HasSubstr(std::string(option) + " does nothing with a surface without cells"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("--surface does nothing")));
}

TEST(Options, LabelFeaturesGoesByTheFeatureAngle) {
  Tool tool;
  tool.write("in.mesh", kTwoCells);
  EXPECT_THAT(tool.run("in.mesh -o a.mesh --label-features --feature-angle 50").err,
              Not(HasSubstr("--feature-angle")));
  EXPECT_THAT(tool.run("in.mesh -o a.mesh --feature-angle 50").err, HasSubstr("--feature-angle counts only"));
}

}  // namespace
}  // namespace hfr::app::test
