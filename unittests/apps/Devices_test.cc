// SPDX-License-Identifier: BSD-3-Clause
// --device and `hfremesh devices`, and what happens when the device is missing or fails. The loader that
// fails is unittests/Device/FailingLoader.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "Tool.hh"
#include "hfremesh/HalfFace/Config.hh"

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

TEST_F(Devices, ThereIsOneWhereTheEnvironmentAsksForOne) {
  const char* required = std::getenv("HFR_REQUIRE_DEVICE");
  if (!required) GTEST_SKIP() << "HFR_REQUIRE_DEVICE is not set";
  EXPECT_TRUE(has_device()) << "no test has run on a device; is pocl-opencl-icd installed?";
}

struct DeviceCase {
  const char* generate;
  const char* options;
  bool reconnects;  ///< there; all of them smooth there
  int code;
};
std::ostream& operator<<(std::ostream& out, const DeviceCase& kind) {
  return out << kind.generate << " " << kind.options;
}

class DeviceOutput : public Devices, public testing::WithParamInterface<DeviceCase> {};

TEST_P(DeviceOutput, IsTheFileOfTheProcessor) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  const auto run = [&](const std::string& name, const std::string& how) {
    const Outcome outcome = tool_.run("in.mesh -o " + name + " -q --json " + name + ".json " +
                                      std::string(GetParam().options) + " " + how);
    EXPECT_EQ(outcome.code, GetParam().code) << outcome.err;
    return tool_.content(name);
  };
  ASSERT_EQ(tool_.run("generate " + std::string(GetParam().generate) + " -o in.mesh -q").code, 0);
  const std::string one = run("one.mesh", "-j 1");
  ASSERT_NE(one, tool_.content("in.mesh"));
  EXPECT_TRUE(one == run("three.mesh", "-j 3"));
  EXPECT_TRUE(one == run("there.mesh", "--device opencl"));
  EXPECT_TRUE(one == run("groups.mesh", "--device opencl --work-group 16"));
  EXPECT_TRUE(one == run("hybrid.mesh", "--device opencl --hybrid"));
  const json report = json::parse(tool_.content("there.mesh.json"));
  EXPECT_TRUE(report["device"]["name"].is_string());
  bool reconnected = false, smoothed = false;
  for (const json& pass : report["passes"])
    if (pass["on_device"] == true) (pass["op"] == "smooth" ? smoothed : reconnected) = true;
  EXPECT_TRUE(smoothed);
  EXPECT_EQ(reconnected, GetParam().reconnects);
}

INSTANTIATE_TEST_SUITE_P(
    All, DeviceOutput,
    testing::Values(DeviceCase{"cavity --n 8 8 8", "", true, 0},
                    DeviceCase{"cavity --n 8 8 8", "--bulk-nodes", true, 0},
                    DeviceCase{"cavity --n 6 7 8 --jitter 0.25", "--compat jpdc2013", false, 0},
                    DeviceCase{"box --n 9 9 9 --jitter 0.3", "--smoother candidates", true, 0},
                    DeviceCase{"box --n 2 30 12 --jitter 0.3", "--iterations 5", true, 0},
                    DeviceCase{"box --n 8 8 8 --jitter 0.25 --regions 2", "", true, 0},
                    // Folded on its frozen boundary, so that inverted cells remain.
                    DeviceCase{"box --n 8 8 8 --jitter 0.45", "", false, 4}));

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

TEST_F(Devices, DeviceThatRoundsOtherwiseIsRefused) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  expect_refused(failing("HFR_CACHE_DIR=$PWD/cache HFR_FAIL_ROUNDING=1"),
                 "does not round as the kernels say");
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

/// Cells so long that more of a round's candidates improve something than there is room for at first, and
/// enough of them for --device auto.
constexpr const char* kGrowing = "generate box --n 21 21 21 --high 1 1 20 --jitter 0.2 -o long.mesh -q";

TEST_F(Devices, NoMemoryToGrowKeepsTheMeshAndEndsWithSix) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  ASSERT_EQ(tool_.run(kGrowing).code, 0);
  const Outcome outcome =
      tool_.shell(failing("HFR_FAIL_GROWTH=3") + "$TOOL long.mesh -o out.mesh -q --device opencl");
  EXPECT_EQ(outcome.code, 6);
  EXPECT_THAT(outcome.err, HasSubstr("clCreateBuffer failed with CL_MEM_OBJECT_ALLOCATION_FAILURE"));
  EXPECT_THAT(outcome.err, HasSubstr("the mesh is that of the last finished round"));
  EXPECT_EQ(tool_.run("check out.mesh -q").code, 0);
}

TEST_F(Devices, ProcessorTakesOverFromADeviceThatFailsInTheMiddle) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  ASSERT_EQ(tool_.run(kGrowing).code, 0);
  const std::string options = "long.mesh --iterations 1 --bulk-nodes ";
  const int code = tool_.run(options + "-o cpu.mesh").code;
  const std::string expected = tool_.content("cpu.mesh");
  std::set<std::string> done_there;
  for (const char* failure : {"HFR_FAIL_GROWTH=3", "HFR_FAIL_ENQUEUE=300", "HFR_FAIL_ENQUEUE=850"}) {
    const Outcome outcome =
        tool_.shell(failing("HFR_PRETEND_GPU=1 " + std::string(failure)) +
                    "$TOOL -o out.mesh --device auto --json out.json --work-group 1 " + options);
    EXPECT_EQ(outcome.code, code) << failure << outcome.err;
    EXPECT_TRUE(tool_.content("out.mesh") == expected) << failure;
    EXPECT_THAT(outcome.err, HasSubstr("note: no device, or not to the end: ")) << failure;
    const json report = json::parse(tool_.content("out.json"));
    for (const json& pass : report["passes"])
      if (pass["on_device"] == true) done_there.insert(pass["op"]);
  }
  EXPECT_TRUE(done_there.contains("node")) << "no removed vertices were there when the device failed";
}

TEST_F(Devices, DeviceLostAnywhereKeepsTheMeshOfTheLastFinishedRound) {
  if (!has_device()) GTEST_SKIP() << "there is no OpenCL device";
  ASSERT_EQ(tool_.run("in.mesh -o whole.mesh -q").code, 0);
  std::set<std::string> outputs;
  for (const int launch : {2, 20, 60, 150, 400}) {
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
