// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_DEVICE_HH
#define HFR_DEVICE_DEVICE_HH

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hfr {

/// An OpenCL device as its driver describes it.
struct DeviceInfo {
  int platform = 0;  ///< numbers as in "opencl:platform.device"
  int device = 0;
  std::string name, vendor, platform_name;
  std::string version;  ///< of OpenCL, "OpenCL 3.0 …"
  std::string driver;
  bool is_cpu = false;
  unsigned compute_units = 0;
  std::uint64_t memory = 0;          ///< bytes
  std::uint64_t max_allocation = 0;  ///< bytes of one buffer
  bool has_double = false;           ///< 64-bit floating point
  std::string problem;               ///< why no run can use it; empty when one can

  /// "opencl:0.0".
  std::string id() const;
};

/// Devices of all platforms, in the loader's order; empty when there is none. Throws DeviceError when the
/// loader is missing, fails, or this build has no OpenCL.
std::vector<DeviceInfo> list_devices();

/// Where a run is to work.
struct DeviceChoice {
  enum class Kind {
    kCpu,    ///< on the processor's threads
    kAuto,   ///< on the first usable device that is no CPU, else on the processor's threads
    kOpenCl  ///< on an OpenCL device or not at all
  };
  Kind kind = Kind::kCpu;
  int platform = -1;  ///< for kOpenCl; -1: the first usable device, GPUs first
  int device = -1;

  bool operator==(const DeviceChoice&) const = default;
};

/// How device code is launched; the results do not depend on it.
struct DeviceTuning {
  unsigned work_group = 0;  ///< work-items of a group: 1, or a power of two up to 256; 0: by kind of device
  unsigned groups = 0;      ///< work-groups of a launch; 0: by the number of compute units
  bool profile = false;     ///< measure every kernel; see DeviceMesh::profile()
  unsigned spare = 0;  ///< room at first for so many more cells, and for so many candidates; 0: by the mesh
};

/// Time that one kernel took, over all its launches.
struct KernelTime {
  std::string kernel;
  std::size_t launches = 0;
  double seconds = 0;
};

/// From "cpu", "auto", "opencl" or "opencl:PLATFORM.DEVICE". Throws InvalidInput that lists the forms.
DeviceChoice device_choice_from_name(const std::string& name);

/// The device that the choice means. Throws DeviceError that says why there is none. For kCpu there is never
/// one.
DeviceInfo find_device(const DeviceChoice& choice);

}  // namespace hfr

#endif
