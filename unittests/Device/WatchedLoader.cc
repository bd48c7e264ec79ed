// SPDX-License-Identifier: BSD-3-Clause
// An OpenCL loader between a program and oclgrind 21.10, which it is linked with; scripts/oclgrind.sh names
// it in HFR_OPENCL_LIBRARY. oclgrind's search for uninitialised reads keeps a shadow of every buffer, which
//   - is cut to the length of the last write from the host: what kernels write behind it is forgotten;
//   - does not follow copies from buffer to buffer;
//   - goes on to the next buffer at the same place when a buffer is freed.
// Each gives reports about good kernels. So what the host writes and what the device copies goes through a
// kernel here, whose writes are followed, and no buffer is ever freed.
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>
#include <dlfcn.h>

#include <map>

namespace {

template <class F>
F real(F, const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}
#define REAL(name) real(&name, #name)

constexpr const char* kSource =
    "__kernel void copy_words(__global const uint* from, uint from_at, __global uint* to, uint to_at) {\n"
    "  to[to_at + get_global_id(0)] = from[from_at + get_global_id(0)];\n"
    "}\n"
    "__kernel void copy_bytes(__global const uchar* from, uint from_at, __global uchar* to, uint to_at) {\n"
    "  to[to_at + get_global_id(0)] = from[from_at + get_global_id(0)];\n"
    "}\n";

template <class T>
T of_queue(cl_command_queue queue, cl_command_queue_info what) {
  T value{};
  clGetCommandQueueInfo(queue, what, sizeof value, &value, nullptr);
  return value;
}

/// The program above in the queue's context; null where it does not compile.
cl_program program_of(cl_command_queue queue) {
  static std::map<cl_context, cl_program> programs;
  const auto context = of_queue<cl_context>(queue, CL_QUEUE_CONTEXT);
  const auto found = programs.find(context);
  if (found != programs.end()) return found->second;
  const auto device = of_queue<cl_device_id>(queue, CL_QUEUE_DEVICE);
  const char* source = kSource;
  cl_program program = clCreateProgramWithSource(context, 1, &source, nullptr, nullptr);
  if (clBuildProgram(program, 1, &device, "", nullptr, nullptr) != CL_SUCCESS) program = nullptr;
  return programs[context] = program;
}

cl_int copy(cl_command_queue queue, cl_mem from, size_t from_at, cl_mem to, size_t to_at, size_t size) {
  const cl_program program = program_of(queue);
  if (!program) return CL_BUILD_PROGRAM_FAILURE;
  const size_t unit = (from_at | to_at | size) % sizeof(cl_uint) == 0 ? sizeof(cl_uint) : 1;
  const cl_kernel kernel = clCreateKernel(program, unit == 1 ? "copy_bytes" : "copy_words", nullptr);
  const auto from_unit = static_cast<cl_uint>(from_at / unit);
  const auto to_unit = static_cast<cl_uint>(to_at / unit);
  clSetKernelArg(kernel, 0, sizeof from, &from);
  clSetKernelArg(kernel, 1, sizeof from_unit, &from_unit);
  clSetKernelArg(kernel, 2, sizeof to, &to);
  clSetKernelArg(kernel, 3, sizeof to_unit, &to_unit);
  const size_t n = size / unit;
  cl_int error = clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &n, nullptr, 0, nullptr, nullptr);
  if (error == CL_SUCCESS) error = clFinish(queue);
  clReleaseKernel(kernel);
  return error;
}

}  // namespace

extern "C" {

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool, size_t offset, size_t size,
                            const void* from, cl_uint, const cl_event*, cl_event*) {
  cl_int error = CL_SUCCESS;
  const auto context = of_queue<cl_context>(queue, CL_QUEUE_CONTEXT);
  const cl_mem staging = clCreateBuffer(context, CL_MEM_READ_WRITE, size, nullptr, &error);
  if (error != CL_SUCCESS) return error;
  error = REAL(clEnqueueWriteBuffer)(queue, staging, CL_TRUE, 0, size, from, 0, nullptr, nullptr);
  return error == CL_SUCCESS ? copy(queue, staging, 0, buffer, offset, size) : error;
}

cl_int clEnqueueCopyBuffer(cl_command_queue queue, cl_mem from, cl_mem to, size_t from_at, size_t to_at,
                           size_t size, cl_uint, const cl_event*, cl_event*) {
  return copy(queue, from, from_at, to, to_at, size);
}

cl_int clReleaseMemObject(cl_mem) { return CL_SUCCESS; }

}  // extern "C"
