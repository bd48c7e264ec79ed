// SPDX-License-Identifier: BSD-3-Clause
// --device and `hfremesh devices`, and what happens when the device is missing or fails. The loader that
// fails is unittests/Device/FailingLoader.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "HalfFace/Config.hh"
#include "Tool.hh"

namespace hfr::app::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Devices : public testing::Test {
 protected:
  void SetUp() override {
#ifndef HFR_OPENCL
    GTEST_SKIP() << "this build has no OpenCL";
#endif
    ASSERT_EQ(tool_.run("generate cavity --n 8 8 8 -o in.mesh -q").code, 0);
  }
  /// Skips the rest of the test where there is no device to fail.
  bool has_device() {
    const json report = json::parse(tool_.run("devices --json -").out);
    for (const json& device : report["devices"])
      if (device["usable"]) return true;
    return false;
  }
#ifdef HFR_FAILING_LOADER
  static std::string failing(const std::string& variable) {
    return "HFR_OPENCL_LIBRARY=" + std::string(HFR_FAILING_LOADER) + " " + variable + " ";
  }
#endif
  /// Exit code 6, one line that holds `what`, and nothing written.
  void expect_refused(const std::string& environment, const std::string& what) {
    const Outcome outcome = tool_.shell(environment + " $TOOL in.mesh -o out.mesh -q --device opencl");
    EXPECT_EQ(outcome.code, 6) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(what));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(tool_.path("out.mesh")));
    // Where the choice is free, the same failure leaves a note.
    const Outcome free = tool_.shell(environment + " $TOOL in.mesh -o free.mesh --device auto");
    EXPECT_EQ(free.code, 0) << free.err;
    EXPECT_THAT(free.err, HasSubstr("note: "));
  }
  Tool tool_;
};

TEST_F(Devices, MissingLoaderIsAnAnswerToTheQuestionForDevices) {
  const Outcome outcome = tool_.shell("HFR_OPENCL_LIBRARY=/no/such/library.so $TOOL devices");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("no OpenCL device: there is no OpenCL loader"));
}

TEST_F(Devices, MissingLoaderIsExitCodeSixOnlyWhereADeviceWasNamed) {
  EXPECT_EQ(tool_.shell("HFR_OPENCL_LIBRARY=/no/such/library.so $TOOL in.mesh -o cpu.mesh -q").code, 0);
  expect_refused("HFR_OPENCL_LIBRARY=/no/such/library.so", "there is no OpenCL loader");
}

TEST_F(Devices, NoPlatform) {
  std::filesystem::create_directory(tool_.path("empty"));
  const Outcome outcome = tool_.shell("OCL_ICD_VENDORS=$PWD/empty/ $TOOL devices");
  EXPECT_EQ(outcome.code, 0);
  if (outcome.out.find("no OpenCL device") == std::string::npos)
    GTEST_SKIP() << "another loader than ocl-icd";
  expect_refused("OCL_ICD_VENDORS=$PWD/empty/", "OpenCL");
}

TEST_F(Devices, ListsWhatEveryDeviceCanDo) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  const json report = json::parse(tool_.run("devices --json -").out);
  const json& device = report["devices"][0];
  EXPECT_EQ(device["id"], "opencl:0.0");
  EXPECT_GT(device["memory"], 0);
  EXPECT_TRUE(device["fp64"].is_boolean());
  EXPECT_THAT(tool_.run("devices -v").out, HasSubstr("opencl:0.0"));
  EXPECT_EQ(tool_.run("in.mesh -o out.mesh -q --device opencl:99.0").code, 6);
  EXPECT_EQ(tool_.run("in.mesh -o out.mesh -q --device gpu").code, 1);
}

TEST_F(Devices, OutputIsTheFileOfTheProcessor) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  EXPECT_EQ(tool_.run("in.mesh -o cpu.mesh -q -j 1").code, 0);
  EXPECT_EQ(tool_.run("in.mesh -o three.mesh -q -j 3").code, 0);
  EXPECT_EQ(tool_.run("in.mesh -o there.mesh -q --device opencl --json report.json").code, 0);
  EXPECT_EQ(tool_.content("cpu.mesh"), tool_.content("there.mesh"));
  EXPECT_EQ(tool_.content("cpu.mesh"), tool_.content("three.mesh"));
  const json report = json::parse(tool_.content("report.json"));
  EXPECT_TRUE(report["device"]["name"].is_string());
  EXPECT_TRUE(std::any_of(report["passes"].begin(), report["passes"].end(),
                          [](const json& pass) { return pass["on_device"] == true; }));
}

#ifdef HFR_FAILING_LOADER
TEST_F(Devices, NoDoubles) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  expect_refused(failing("HFR_FAIL_FP64=1"), "fp64");
  EXPECT_THAT(tool_.shell(failing("HFR_FAIL_FP64=1") + "$TOOL devices").out,
              HasSubstr("no: it has no 64-bit"));
}

TEST_F(Devices, BuildErrorShowsTheLog) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  expect_refused(failing("HFR_CACHE_DIR=$PWD/cache HFR_FAIL_BUILD=1"),
                 "clBuildProgram failed with CL_BUILD_PROGRAM_FAILURE");
  EXPECT_THAT(tool_
                  .shell(failing("HFR_CACHE_DIR=$PWD/cache HFR_FAIL_BUILD=1") +
                         "$TOOL in.mesh -o out.mesh -q --device opencl")
                  .err,
              HasSubstr("no_such_word"));
}

TEST_F(Devices, MeshBeyondTheMemoryIsRefused) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  expect_refused(failing("HFR_FAIL_MEMORY=100000"), "too large");
}

TEST_F(Devices, OutOfMemoryKeepsTheMeshAndEndsWithSix) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  const Outcome outcome =
      tool_.shell(failing("HFR_FAIL_BUFFER=5") + "$TOOL in.mesh -o out.mesh -q --device opencl");
  EXPECT_EQ(outcome.code, 6);
  EXPECT_THAT(outcome.err, HasSubstr("clCreateBuffer failed with CL_MEM_OBJECT_ALLOCATION_FAILURE"));
  EXPECT_EQ(tool_.run("check out.mesh -q").code, 0);
}

TEST_F(Devices, DeviceLostAnywhereKeepsTheMeshOfTheLastFinishedRound) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  ASSERT_EQ(tool_.run("in.mesh -o whole.mesh -q").code, 0);
  std::set<std::string> outputs;
  for (const int launch : {1, 20, 60, 150, 400}) {
    const Outcome outcome = tool_.shell(failing("HFR_FAIL_ENQUEUE=" + std::to_string(launch)) +
                                        "$TOOL in.mesh -o out.mesh -q --device opencl");
    EXPECT_EQ(outcome.code, 6) << launch;
    EXPECT_THAT(outcome.err, HasSubstr("the mesh is that of the last finished round"));
    EXPECT_THAT(outcome.err, HasSubstr("CL_OUT_OF_RESOURCES"));
    EXPECT_EQ(tool_.run("check out.mesh -q").code, 0) << launch;
    outputs.insert(tool_.content("out.mesh"));
  }
  EXPECT_GE(outputs.size(), 3U) << "the rounds that were finished are not kept";
}
#endif

}  // namespace
}  // namespace hfr::app::test
