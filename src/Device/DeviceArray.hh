// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_DEVICE_ARRAY_HH
#define HFR_DEVICE_DEVICE_ARRAY_HH

#include <concepts>
#include <cstddef>

#include "Device/OpenCl.hh"

/// What KernelArguments.hh, which is made of the kernels, is written in.
namespace hfr::detail {

/// An array on the device. `room` counts the items of type T that the buffer holds.
template <class T>
struct DeviceArray {
  cl::Buffer buffer;
  std::size_t room = 0;
};

/// A plain argument of a kernel: never left out, and of the very type that the kernel has.
template <class T>
struct KernelValue {
  template <std::same_as<T> U>
  KernelValue(U given) : value(given) {}
  T value;
};

/// Types of kernel arguments, one a kernel.
template <class... Kernels>
struct KernelList {
  static constexpr std::size_t kSize = sizeof...(Kernels);
  /// Calls visit.operator()<Kernel>() for each.
  template <class Visit>
  static void for_each(Visit&& visit) {
    (visit.template operator()<Kernels>(), ...);
  }
};

}  // namespace hfr::detail

#endif
