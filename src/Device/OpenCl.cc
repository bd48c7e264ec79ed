// SPDX-License-Identifier: BSD-3-Clause
#include "Device/OpenCl.hh"

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <mutex>

#include "Device/ProgramCache.hh"

namespace hfr::detail {
namespace {

constexpr std::array<const char*, kClFunctions> kNames = {"clBuildProgram",
                                                          "clCreateBuffer",
                                                          "clCreateCommandQueue",
                                                          "clCreateContext",
                                                          "clCreateKernel",
                                                          "clCreateProgramWithBinary",
                                                          "clCreateProgramWithSource",
                                                          "clEnqueueCopyBuffer",
                                                          "clEnqueueNDRangeKernel",
                                                          "clEnqueueReadBuffer",
                                                          "clEnqueueWriteBuffer",
                                                          "clFinish",
                                                          "clGetDeviceIDs",
                                                          "clGetDeviceInfo",
                                                          "clGetEventProfilingInfo",
                                                          "clGetPlatformIDs",
                                                          "clGetPlatformInfo",
                                                          "clGetProgramBuildInfo",
                                                          "clGetProgramInfo",
                                                          "clReleaseCommandQueue",
                                                          "clReleaseContext",
                                                          "clReleaseDevice",
                                                          "clReleaseEvent",
                                                          "clReleaseKernel",
                                                          "clReleaseMemObject",
                                                          "clReleaseProgram",
                                                          "clRetainCommandQueue",
                                                          "clRetainContext",
                                                          "clRetainDevice",
                                                          "clRetainEvent",
                                                          "clRetainKernel",
                                                          "clRetainMemObject",
                                                          "clRetainProgram",
                                                          "clSetKernelArg"};

struct ErrorName {
  cl_int error;
  const char* name;
};

#define HFR_NAMED(error) \
  { error, #error }
/// CL_PLATFORM_NOT_FOUND_KHR is defined by an extension's header.
constexpr cl_int kPlatformNotFound = -1001;
constexpr ErrorName kErrors[] = {HFR_NAMED(CL_DEVICE_NOT_FOUND),
                                 HFR_NAMED(CL_DEVICE_NOT_AVAILABLE),
                                 HFR_NAMED(CL_COMPILER_NOT_AVAILABLE),
                                 HFR_NAMED(CL_MEM_OBJECT_ALLOCATION_FAILURE),
                                 HFR_NAMED(CL_OUT_OF_RESOURCES),
                                 HFR_NAMED(CL_OUT_OF_HOST_MEMORY),
                                 HFR_NAMED(CL_PROFILING_INFO_NOT_AVAILABLE),
                                 HFR_NAMED(CL_BUILD_PROGRAM_FAILURE),
                                 HFR_NAMED(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST),
                                 HFR_NAMED(CL_LINK_PROGRAM_FAILURE),
                                 HFR_NAMED(CL_INVALID_VALUE),
                                 HFR_NAMED(CL_INVALID_PLATFORM),
                                 HFR_NAMED(CL_INVALID_DEVICE),
                                 HFR_NAMED(CL_INVALID_CONTEXT),
                                 HFR_NAMED(CL_INVALID_COMMAND_QUEUE),
                                 HFR_NAMED(CL_INVALID_MEM_OBJECT),
                                 HFR_NAMED(CL_INVALID_BINARY),
                                 HFR_NAMED(CL_INVALID_BUILD_OPTIONS),
                                 HFR_NAMED(CL_INVALID_PROGRAM),
                                 HFR_NAMED(CL_INVALID_PROGRAM_EXECUTABLE),
                                 HFR_NAMED(CL_INVALID_KERNEL_NAME),
                                 HFR_NAMED(CL_INVALID_KERNEL),
                                 HFR_NAMED(CL_INVALID_ARG_INDEX),
                                 HFR_NAMED(CL_INVALID_ARG_VALUE),
                                 HFR_NAMED(CL_INVALID_ARG_SIZE),
                                 HFR_NAMED(CL_INVALID_KERNEL_ARGS),
                                 HFR_NAMED(CL_INVALID_WORK_GROUP_SIZE),
                                 HFR_NAMED(CL_INVALID_GLOBAL_WORK_SIZE),
                                 HFR_NAMED(CL_INVALID_EVENT),
                                 HFR_NAMED(CL_INVALID_OPERATION),
                                 HFR_NAMED(CL_INVALID_BUFFER_SIZE),
                                 {kPlatformNotFound, "CL_PLATFORM_NOT_FOUND_KHR"}};
#undef HFR_NAMED

struct Loader {
  std::array<void*, kClFunctions> entry{};
  std::string problem;
};

Loader open_loader() {
  Loader loader;
  const char* chosen = std::getenv("HFR_OPENCL_LIBRARY");
  const std::string name = chosen ? chosen : "libOpenCL.so.1";
  // Never closed: drivers leave threads behind that live until the process ends.
  void* library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* why = dlerror();
    loader.problem = "there is no OpenCL loader on this machine: " + std::string(why ? why : name);
    return loader;
  }
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    loader.entry[i] = dlsym(library, kNames[i]);
    if (!loader.entry[i]) loader.problem = "the OpenCL loader " + name + " has no " + kNames[i];
  }
  // PoCL crashes where it cannot write its cache, so it is given a folder that was tried.
  const char* theirs = std::getenv("POCL_CACHE_DIR");
  if (loader.problem.empty() && !(theirs && is_writable_folder(theirs))) {
    const std::filesystem::path folder = cache_folder();
    if (folder.empty())
      loader.problem = "no folder for compiled kernels can be written: name one in HFR_CACHE_DIR";
    else
      setenv("POCL_CACHE_DIR", (folder / "pocl").c_str(), 1);
  }
  return loader;
}

const Loader& loader() {
  static const Loader the_loader = open_loader();
  return the_loader;
}

}  // namespace

std::string cl_error_name(cl_int error) {
  for (const ErrorName& named : kErrors)
    if (named.error == error) return named.name;
  return "error " + std::to_string(error);
}

void load_open_cl() {
  if (!loader().problem.empty()) throw DeviceError(loader().problem);
}

void* cl_entry(ClFunction function) {
  load_open_cl();
  return loader().entry[function];
}

}  // namespace hfr::detail
