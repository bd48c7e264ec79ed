// SPDX-License-Identifier: BSD-3-Clause
#include "Device/Discovery.hh"

namespace hfr {
namespace detail {
namespace {

/// Text of a driver without the zero bytes and blanks that some append.
std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
  return text;
}

std::vector<cl::Platform> platforms() {
  std::vector<cl::Platform> all;
  try {
    cl::Platform::get(&all);
  } catch (const cl::Error& error) {
    // A loader that finds no driver calls that an error.
    if (cl_error_name(error.err()) != "CL_PLATFORM_NOT_FOUND_KHR") throw;
  }
  return all;
}

std::vector<cl::Device> devices_of(const cl::Platform& platform) {
  std::vector<cl::Device> all;
  try {
    platform.getDevices(CL_DEVICE_TYPE_ALL, &all);
  } catch (const cl::Error& error) {
    if (error.err() != CL_DEVICE_NOT_FOUND) throw;
  }
  return all;
}

std::string problem_of(const cl::Device& device, bool has_double) {
  if (!device.getInfo<CL_DEVICE_AVAILABLE>()) return "it is not available";
  if (!device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>()) return "its driver has no compiler";
  if (!has_double) return "it has no 64-bit floating point (fp64)";
  if (!device.getInfo<CL_DEVICE_ENDIAN_LITTLE>()) return "it is not little-endian";
  return "";
}

}  // namespace

std::vector<std::pair<DeviceInfo, cl::Device>> discover() {
  load_open_cl();
  return checked("looking for devices", [] {
    std::vector<std::pair<DeviceInfo, cl::Device>> found;
    int platform_number = 0;
    for (const cl::Platform& platform : platforms()) {
      int device_number = 0;
      for (const cl::Device& device : devices_of(platform)) {
        DeviceInfo info;
        info.platform = platform_number;
        info.device = device_number++;
        info.platform_name = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
        info.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
        info.vendor = trimmed(device.getInfo<CL_DEVICE_VENDOR>());
        info.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
        info.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
        info.is_cpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
        info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
        info.memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
        info.max_allocation = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
        info.has_double = device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
        info.problem = problem_of(device, info.has_double);
        found.emplace_back(std::move(info), device);
      }
      ++platform_number;
    }
    return found;
  });
}

}  // namespace detail

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> all;
  for (auto& [info, device] : detail::discover()) all.push_back(std::move(info));
  return all;
}

}  // namespace hfr
