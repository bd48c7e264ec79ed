// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>

#include "Device/Device.hh"
#include "HalfFace/Errors.hh"

namespace hfr {

std::string DeviceInfo::id() const {
  return "opencl:" + std::to_string(platform) + "." + std::to_string(device);
}

DeviceChoice device_choice_from_name(const std::string& name) {
  using Kind = DeviceChoice::Kind;
  if (name == "cpu") return {};
  if (name == "auto") return {Kind::kAuto};
  if (name == "opencl") return {Kind::kOpenCl};
  const std::string prefix = "opencl:";
  DeviceChoice choice{Kind::kOpenCl};
  if (name.starts_with(prefix)) {
    const char* const end = name.data() + name.size();
    const auto first = std::from_chars(name.data() + prefix.size(), end, choice.platform);
    if (first.ec == std::errc() && first.ptr != end && *first.ptr == '.') {
      const auto second = std::from_chars(first.ptr + 1, end, choice.device);
      if (second.ec == std::errc() && second.ptr == end && choice.platform >= 0 && choice.device >= 0)
        return choice;
    }
  }
  throw InvalidInput("a device is 'cpu', 'auto', 'opencl' or 'opencl:PLATFORM.DEVICE', not '" + name + "'");
}

DeviceInfo find_device(const DeviceChoice& choice) {
  using Kind = DeviceChoice::Kind;
  if (choice.kind == Kind::kCpu) throw DeviceError("the processor's threads were chosen, no device");
  const std::vector<DeviceInfo> devices = list_devices();
  if (devices.empty())
    throw DeviceError("there is no OpenCL device: no driver is installed; 'hfremesh devices' lists them");
  std::string problems;
  const DeviceInfo* found = nullptr;
  for (const DeviceInfo& device : devices) {
    if (choice.platform >= 0 && (device.platform != choice.platform || device.device != choice.device))
      continue;
    if (!device.problem.empty()) {
      problems += (problems.empty() ? "" : "; ") + device.id() + " (" + device.name + "): " + device.problem;
      continue;
    }
    // With PoCL on the same cores, the threads of this process do the same work and need no copies.
    if (choice.kind == Kind::kAuto && device.is_cpu) continue;
    if (!found || (found->is_cpu && !device.is_cpu)) found = &device;
  }
  if (found) return *found;
  if (!problems.empty()) throw DeviceError("no OpenCL device can be used: " + problems);
  if (choice.kind == Kind::kAuto) throw DeviceError("there is no OpenCL device but the processor itself");
  throw DeviceError("there is no device opencl:" + std::to_string(choice.platform) + "." +
                    std::to_string(choice.device) + "; 'hfremesh devices' lists them");
}

}  // namespace hfr
