// SPDX-License-Identifier: BSD-3-Clause
#include "Device/Program.hh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Device/Discovery.hh"
#include "Device/Scratch.hh"

namespace hfr::detail {
namespace {

using testing::HasSubstr;

class Program : public testing::Test {
 protected:
  void SetUp() override {
    // PoCL reads its own folder once a process, and folder_ goes with the test.
    static const test::ScratchFolder pocl;
    setenv("POCL_CACHE_DIR", pocl.path().c_str(), 1);
    try {
      const DeviceInfo wanted = find_device({DeviceChoice::Kind::kOpenCl});
      for (auto& [info, device] : discover())
        if (info.id() == wanted.id()) found_ = {info, device};
    } catch (const DeviceError& error) {
      GTEST_SKIP() << error.what();
    }
    context_ = cl::Context(found_.second);
  }
  BuiltProgram build(const std::string& source, const std::string& options = "") {
    return build_program(context_, found_.second, found_.first, source, options);
  }

  test::ScratchFolder folder_;
  test::ScopedVariable variable_{"HFR_CACHE_DIR", folder_.path().c_str()};
  std::pair<DeviceInfo, cl::Device> found_;
  cl::Context context_;
};

TEST_F(Program, SecondBuildComesFromTheCache) {
  const std::string source = "__kernel void f(__global int* a) { a[get_global_id(0)] = 1; }\n";
  EXPECT_FALSE(build(source).from_cache);
  EXPECT_TRUE(build(source).from_cache);
  EXPECT_FALSE(build(source + " ").from_cache) << "another source";
  EXPECT_FALSE(build(source, "-DX=1").from_cache) << "other options";
}

TEST_F(Program, StoredBinaryThatIsDamagedIsBuiltAnew) {
  const std::string source = "__kernel void f(__global int* a) { a[get_global_id(0)] = 2; }\n";
  build(source);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    if (!entry.is_regular_file()) continue;
    const auto size = entry.file_size();
    std::filesystem::resize_file(entry.path(), size / 2);
    std::filesystem::resize_file(entry.path(), size);
  }
  const BuiltProgram again = build(source);
  EXPECT_FALSE(again.from_cache);
  EXPECT_NO_THROW(cl::Kernel(again.program, "f"));
}

TEST_F(Program, CompilersLogIsPartOfTheError) {
  try {
    build("__kernel void f(__global int* a) { a[0] = no_such_name; }\n");
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("clBuildProgram failed with CL_BUILD_PROGRAM_FAILURE"));
    EXPECT_THAT(error.what(), HasSubstr("no_such_name"));
  }
}

TEST_F(Program, CheckedNamesTheCallAndTheError) {
  try {
    checked("trying", [&] { return cl::Kernel(build("__kernel void f() {}\n").program, "g"); });
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("trying: clCreateKernel failed with CL_INVALID_KERNEL_NAME"));
  }
  EXPECT_EQ(cl_error_name(-12345), "error -12345");
}

}  // namespace
}  // namespace hfr::detail
