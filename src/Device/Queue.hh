// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_QUEUE_HH
#define HFR_DEVICE_QUEUE_HH

#include <map>
#include <string>
#include <vector>

#include "Device/DeviceMesh.hh"
#include "Device/KernelArguments.hh"
#include "Device/OpenCl.hh"

namespace hfr::detail {

/// One in-order queue with its program; internal to this folder. Every call is checked.
class Queue {
 public:
  Queue(const DeviceChoice& choice, DeviceTuning tuning);

  const DeviceInfo& info() const { return info_; }
  bool from_cache() const { return from_cache_; }
  unsigned groups() const { return groups_; }
  unsigned work_items() const { return groups_ * work_group_; }
  bool is_cpu_style() const { return work_group_ == 1; }

  /// Makes room for n items, forgetting what was there; throws DeviceError where one buffer cannot be that
  /// large.
  template <class T>
  void reserve(DeviceArray<T>& array, std::size_t n) {
    if (n <= array.room) return;
    array.buffer = cl::Buffer();  // first, so that both need not fit
    array.room = 0;
    array.buffer = allocate(n * sizeof(T));
    array.room = n;
  }
  /// The same, keeping what is there.
  template <class T>
  void grow(DeviceArray<T>& array, std::size_t n) {
    if (n <= array.room) return;
    const cl::Buffer larger = allocate(n * sizeof(T));
    if (array.room > 0) {
      checked("copying on the device",
              [&] { queue_.enqueueCopyBuffer(array.buffer, larger, 0, 0, array.room * sizeof(T)); });
    }
    array.buffer = larger;
    array.room = n;
  }
  template <class T>
  void write(DeviceArray<T>& array, const T* items, std::size_t n) {
    if (n == 0) return;
    checked("writing to the device",
            [&] { queue_.enqueueWriteBuffer(array.buffer, CL_TRUE, 0, n * sizeof(T), items); });
  }
  template <class T>
  void read(const DeviceArray<T>& array, T* items, std::size_t n) {
    if (n == 0) return;
    checked("reading from the device",
            [&] { queue_.enqueueReadBuffer(array.buffer, CL_TRUE, 0, n * sizeof(T), items); });
  }
  /// Items [first, first + n) become `value`. By a kernel: tools that watch what is initialised see it.
  void fill(DeviceArray<cl_uint>& array, cl_uint value, std::size_t first, std::size_t n) {
    launch(
        kernel::fill_words{
            .first = static_cast<cl_uint>(first), .n = static_cast<cl_uint>(n), .value = value},
        {.array = array});
  }
  void fill(DeviceArray<cl_uchar>& array, cl_uchar value, std::size_t first, std::size_t n) {
    launch(
        kernel::fill_bytes{
            .first = static_cast<cl_uint>(first), .n = static_cast<cl_uint>(n), .value = cl_uint{value}},
        {.array = array});
  }

  /// Runs a kernel over all work-items. `values` is a struct of KernelArguments.hh.
  template <class Kernel>
  void launch(const Kernel& values, const typename Kernel::Arrays& arrays) {
    checked(Kernel::kName, [&] {
      cl::Kernel& kernel = kernel_of(Kernel::kName);
      cl_uint index = 0;
      values.for_each(arrays, [&](const auto& argument) { set(kernel, index++, argument); });
      run(kernel, Kernel::kName);
    });
  }

  std::vector<KernelTime> profile();

 private:
  cl::Buffer allocate(std::size_t bytes);
  cl::Kernel& kernel_of(const char* name);
  void run(const cl::Kernel& kernel, const char* name);
  template <class T>
  static void set(cl::Kernel& kernel, cl_uint index, const DeviceArray<T>& array) {
    kernel.setArg(index, array.buffer);
  }
  template <class T>
  static void set(cl::Kernel& kernel, cl_uint index, const KernelValue<T>& value) {
    kernel.setArg(index, value.value);
  }

  DeviceInfo info_;
  unsigned work_group_ = 1, groups_ = 1;
  bool from_cache_ = false;
  bool profiled_ = false;
  cl::Device device_;
  cl::Context context_;
  cl::CommandQueue queue_;
  cl::Program program_;
  std::map<std::string, cl::Kernel> kernels_;
  std::vector<std::pair<const char*, cl::Event>> events_;
};

}  // namespace hfr::detail

#endif
