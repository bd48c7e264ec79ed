// SPDX-License-Identifier: BSD-3-Clause
#include "Device/Program.hh"

#include "Device/ProgramCache.hh"

namespace hfr::detail {
namespace {

/// The stored program, or nothing when the driver does not take it any more.
std::optional<cl::Program> from_binary(const cl::Context& context, const cl::Device& device,
                                       const std::vector<unsigned char>& binary, const std::string& options) {
  try {
    cl::Program program(context, {device}, cl::Program::Binaries{binary});
    program.build(device, options.c_str());
    return program;
  } catch (const cl::Error&) {
    return std::nullopt;
  }
}

}  // namespace

BuiltProgram build_program(const cl::Context& context, const cl::Device& device, const DeviceInfo& info,
                           const std::string& source, const std::string& options) {
  const std::string key = info.platform_name + "\n" + info.version + "\n" + info.vendor + "\n" + info.name +
                          "\n" + info.driver + "\n" + options + "\n" + source;
  if (const auto binary = load_binary(key))
    if (auto program = from_binary(context, device, *binary, options)) return {*program, true};
  cl::Program program = checked("compiling kernels", [&] { return cl::Program(context, source); });
  try {
    program.build(device, options.c_str());
  } catch (const cl::Error& error) {
    std::string log;
    try {
      log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    } catch (const cl::Error&) {
      log = "(the driver gives no log)";
    }
    throw DeviceError("compiling kernels for " + info.name + ": " + error.what() + " failed with " +
                      cl_error_name(error.err()) + "; the compiler says:\n" + log);
  }
  const auto binaries = checked("storing kernels", [&] { return program.getInfo<CL_PROGRAM_BINARIES>(); });
  if (!binaries.empty() && !binaries[0].empty()) save_binary(key, binaries[0]);
  return {program, false};
}

}  // namespace hfr::detail
