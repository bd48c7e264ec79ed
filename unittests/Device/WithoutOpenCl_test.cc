// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "Device/DeviceMesh.hh"
#include "HalfFace/Errors.hh"

namespace hfr::test {
namespace {

TEST(WithoutOpenCl, EverythingSaysHowToGetIt) {
  try {
    list_devices();
    FAIL();
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("HFR_OPENCL"), std::string::npos);
  }
  EXPECT_THROW(DeviceMesh({DeviceChoice::Kind::kOpenCl}), DeviceError);
}

}  // namespace
}  // namespace hfr::test
