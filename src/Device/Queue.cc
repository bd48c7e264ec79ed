// SPDX-License-Identifier: BSD-3-Clause
#include "Device/Queue.hh"

#include <algorithm>

#include "Device/Discovery.hh"
#include "Device/KernelFiles.hh"
#include "Device/Program.hh"

namespace hfr::detail {
namespace {

// On a CPU a group is one work-item that goes through a contiguous part of the items; several a core even out
// what they cost.
constexpr unsigned kGroupsPerCore = 8;
// Elsewhere: enough work-items in flight to hide the latency of memory.
constexpr unsigned kWorkGroup = 128;
constexpr unsigned kGroupsPerUnit = 8;

std::string mebibytes(std::uint64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB"; }

}  // namespace

Queue::Queue(const DeviceChoice& choice, DeviceTuning tuning) : info_(find_device(choice)) {
  for (auto& [info, device] : discover())
    if (info.platform == info_.platform && info.device == info_.device) device_ = device;
  const bool by_default = tuning.work_group == 0;
  work_group_ = !by_default ? tuning.work_group : info_.is_cpu ? 1 : kWorkGroup;
  const unsigned units = std::max(1U, info_.compute_units);
  groups_ = tuning.groups > 0 ? tuning.groups : units * (work_group_ == 1 ? kGroupsPerCore : kGroupsPerUnit);
  profiled_ = tuning.profile;
  checked("opening the device", [&] {
    context_ = cl::Context(device_);
    queue_ = cl::CommandQueue(context_, device_, profiled_ ? CL_QUEUE_PROFILING_ENABLE : 0);
  });
  // No options about floating point: what is written is what is rounded, and FP_CONTRACT is off in the
  // source.
  const BuiltProgram built =
      build_program(context_, device_, info_, kernel_source(), "-DHFR_LOCAL=" + std::to_string(work_group_));
  program_ = built.program;
  from_cache_ = built.from_cache;
}

cl::Buffer Queue::allocate(std::size_t bytes) {
  if (bytes > info_.max_allocation)
    throw DeviceError("the mesh is too large for " + info_.name + ": a buffer of " + mebibytes(bytes) +
                      " is needed, and one may have " + mebibytes(info_.max_allocation));
  return checked("making room on the device",
                 [&] { return cl::Buffer(context_, CL_MEM_READ_WRITE, std::max<std::size_t>(bytes, 16)); });
}

cl::Kernel& Queue::kernel_of(const char* name) {
  const auto found = kernels_.find(name);
  if (found != kernels_.end()) return found->second;
  return kernels_.emplace(name, cl::Kernel(program_, name)).first->second;
}

void Queue::run(const cl::Kernel& kernel, const char* name) {
  cl::Event event;
  queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(std::size_t{groups_} * work_group_),
                              cl::NDRange(work_group_), nullptr, profiled_ ? &event : nullptr);
  if (profiled_) events_.emplace_back(name, event);
}

std::vector<KernelTime> Queue::profile() {
  std::map<std::string, KernelTime> by_kernel;
  checked("reading times", [&] {
    queue_.finish();
    for (const auto& [name, event] : events_) {
      KernelTime& time = by_kernel[name];
      time.kernel = name;
      ++time.launches;
      time.seconds += 1e-9 * static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                                 event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
    }
  });
  std::vector<KernelTime> times;
  for (const auto& [name, time] : by_kernel) times.push_back(time);
  std::sort(times.begin(), times.end(),
            [](const KernelTime& a, const KernelTime& b) { return a.seconds > b.seconds; });
  return times;
}

}  // namespace hfr::detail
