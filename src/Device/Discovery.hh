// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_DISCOVERY_HH
#define HFR_DEVICE_DISCOVERY_HH

#include <utility>
#include <vector>

#include "Device/Device.hh"
#include "Device/OpenCl.hh"

namespace hfr::detail {

/// Every device with its handle, in the order of list_devices(). Throws DeviceError.
std::vector<std::pair<DeviceInfo, cl::Device>> discover();

}  // namespace hfr::detail

#endif
