// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "Device/Device.hh"
#include "HalfFace/Errors.hh"

namespace hfr::test {
namespace {

using Kind = DeviceChoice::Kind;

TEST(DeviceChoice, NamesOfTheCommandLine) {
  EXPECT_EQ(device_choice_from_name("cpu"), DeviceChoice{});
  EXPECT_EQ(device_choice_from_name("auto"), DeviceChoice{Kind::kAuto});
  EXPECT_EQ(device_choice_from_name("opencl"), DeviceChoice{Kind::kOpenCl});
  EXPECT_EQ(device_choice_from_name("opencl:1.20"), (DeviceChoice{Kind::kOpenCl, 1, 20}));
}

TEST(DeviceChoice, AnythingElseIsRefusedWithTheForms) {
  for (const char* name : {"", "gpu", "opencl:", "opencl:1", "opencl:1.", "opencl:.1", "opencl:-1.0",
                           "opencl:0.-1", "opencl:1.2x", "opencl:a.b", "CPU"}) {
    try {
      device_choice_from_name(name);
      ADD_FAILURE() << name;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("opencl:PLATFORM.DEVICE"), std::string::npos) << name;
    }
  }
}

TEST(DeviceChoice, TheProcessorIsNoDevice) { EXPECT_THROW(find_device({}), DeviceError); }

TEST(DeviceChoice, IdIsWhatTheCommandLineTakes) {
  DeviceInfo info;
  info.platform = 2;
  info.device = 3;
  EXPECT_EQ(info.id(), "opencl:2.3");
  EXPECT_EQ(device_choice_from_name(info.id()), (DeviceChoice{Kind::kOpenCl, 2, 3}));
}

}  // namespace
}  // namespace hfr::test
