// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_PROGRAM_HH
#define HFR_DEVICE_PROGRAM_HH

#include <string>

#include "Device/Device.hh"
#include "Device/OpenCl.hh"

namespace hfr::detail {

/// A program that is ready to run, and where it came from.
struct BuiltProgram {
  cl::Program program;
  bool from_cache = false;
};

/// Builds `source` for the device, or takes what an earlier run has stored for the same source, device,
/// driver and options. Throws DeviceError; that of a program that does not compile holds the compiler's log.
BuiltProgram build_program(const cl::Context& context, const cl::Device& device, const DeviceInfo& info,
                           const std::string& source, const std::string& options);

}  // namespace hfr::detail

#endif
