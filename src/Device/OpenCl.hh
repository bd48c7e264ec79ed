// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_DEVICE_OPEN_CL_HH
#define HFR_DEVICE_OPEN_CL_HH

// OpenCL's C++ bindings without linking the loader, internal to this folder. The bindings call the C
// functions by name; here each of these names stands for a forwarder that finds the function in the loader
// when it is first called, so that a program starts on a machine that has no loader.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

namespace hfr::detail {

/// Functions of the loader that are in use.
enum ClFunction {
  kClBuildProgram,
  kClCreateBuffer,
  kClCreateCommandQueue,
  kClCreateContext,
  kClCreateKernel,
  kClCreateProgramWithBinary,
  kClCreateProgramWithSource,
  kClEnqueueCopyBuffer,
  kClEnqueueNDRangeKernel,
  kClEnqueueReadBuffer,
  kClEnqueueWriteBuffer,
  kClFinish,
  kClGetDeviceIDs,
  kClGetDeviceInfo,
  kClGetEventProfilingInfo,
  kClGetPlatformIDs,
  kClGetPlatformInfo,
  kClGetProgramBuildInfo,
  kClGetProgramInfo,
  kClReleaseCommandQueue,
  kClReleaseContext,
  kClReleaseDevice,
  kClReleaseEvent,
  kClReleaseKernel,
  kClReleaseMemObject,
  kClReleaseProgram,
  kClRetainCommandQueue,
  kClRetainContext,
  kClRetainDevice,
  kClRetainEvent,
  kClRetainKernel,
  kClRetainMemObject,
  kClRetainProgram,
  kClSetKernelArg,
  kClFunctions
};

/// Address of the function in the loader. Throws DeviceError when there is no loader; see load_open_cl().
void* cl_entry(ClFunction function);

template <class Signature>
struct ClForward;
template <class R, class... Args>
struct ClForward<R(Args...)> {
  template <ClFunction kFunction>
  static R call(Args... args) {
    return reinterpret_cast<R (*)(Args...)>(cl_entry(kFunction))(args...);
  }
};

}  // namespace hfr::detail

#define HFR_CL(name, number) hfr::detail::ClForward<decltype(::name)>::call<hfr::detail::number>
#define clBuildProgram HFR_CL(clBuildProgram, kClBuildProgram)
#define clCreateBuffer HFR_CL(clCreateBuffer, kClCreateBuffer)
#define clCreateCommandQueue HFR_CL(clCreateCommandQueue, kClCreateCommandQueue)
#define clCreateContext HFR_CL(clCreateContext, kClCreateContext)
#define clCreateKernel HFR_CL(clCreateKernel, kClCreateKernel)
#define clCreateProgramWithBinary HFR_CL(clCreateProgramWithBinary, kClCreateProgramWithBinary)
#define clCreateProgramWithSource HFR_CL(clCreateProgramWithSource, kClCreateProgramWithSource)
#define clEnqueueCopyBuffer HFR_CL(clEnqueueCopyBuffer, kClEnqueueCopyBuffer)
#define clEnqueueNDRangeKernel HFR_CL(clEnqueueNDRangeKernel, kClEnqueueNDRangeKernel)
#define clEnqueueReadBuffer HFR_CL(clEnqueueReadBuffer, kClEnqueueReadBuffer)
#define clEnqueueWriteBuffer HFR_CL(clEnqueueWriteBuffer, kClEnqueueWriteBuffer)
#define clFinish HFR_CL(clFinish, kClFinish)
#define clGetDeviceIDs HFR_CL(clGetDeviceIDs, kClGetDeviceIDs)
#define clGetDeviceInfo HFR_CL(clGetDeviceInfo, kClGetDeviceInfo)
#define clGetEventProfilingInfo HFR_CL(clGetEventProfilingInfo, kClGetEventProfilingInfo)
#define clGetPlatformIDs HFR_CL(clGetPlatformIDs, kClGetPlatformIDs)
#define clGetPlatformInfo HFR_CL(clGetPlatformInfo, kClGetPlatformInfo)
#define clGetProgramBuildInfo HFR_CL(clGetProgramBuildInfo, kClGetProgramBuildInfo)
#define clGetProgramInfo HFR_CL(clGetProgramInfo, kClGetProgramInfo)
#define clReleaseCommandQueue HFR_CL(clReleaseCommandQueue, kClReleaseCommandQueue)
#define clReleaseContext HFR_CL(clReleaseContext, kClReleaseContext)
#define clReleaseDevice HFR_CL(clReleaseDevice, kClReleaseDevice)
#define clReleaseEvent HFR_CL(clReleaseEvent, kClReleaseEvent)
#define clReleaseKernel HFR_CL(clReleaseKernel, kClReleaseKernel)
#define clReleaseMemObject HFR_CL(clReleaseMemObject, kClReleaseMemObject)
#define clReleaseProgram HFR_CL(clReleaseProgram, kClReleaseProgram)
#define clRetainCommandQueue HFR_CL(clRetainCommandQueue, kClRetainCommandQueue)
#define clRetainContext HFR_CL(clRetainContext, kClRetainContext)
#define clRetainEvent HFR_CL(clRetainEvent, kClRetainEvent)
#define clRetainKernel HFR_CL(clRetainKernel, kClRetainKernel)
#define clRetainMemObject HFR_CL(clRetainMemObject, kClRetainMemObject)
#define clRetainProgram HFR_CL(clRetainProgram, kClRetainProgram)
#define clRetainDevice HFR_CL(clRetainDevice, kClRetainDevice)
#define clSetKernelArg HFR_CL(clSetKernelArg, kClSetKernelArg)

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>
#include <string>
#include <utility>

#include "HalfFace/Errors.hh"

namespace hfr::detail {

/// "CL_OUT_OF_RESOURCES" of -5.
std::string cl_error_name(cl_int error);

/// Opens the loader: the library that the environment variable HFR_OPENCL_LIBRARY names, else libOpenCL.so.1.
/// Sees to it that drivers find a folder they can write. Throws DeviceError that says what is missing; may be
/// called again.
void load_open_cl();

/// f(), with an error of OpenCL turned into a DeviceError that names the call and the error. `doing` says in
/// two words what for.
template <class F>
decltype(auto) checked(const char* doing, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (const cl::Error& error) {
    throw DeviceError(std::string(doing) + ": " + error.what() + " failed with " +
                      cl_error_name(error.err()));
  }
}

}  // namespace hfr::detail

#endif
