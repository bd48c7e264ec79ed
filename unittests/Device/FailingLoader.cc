// SPDX-License-Identifier: BSD-3-Clause
// An OpenCL loader that fails where the environment says so; everything else is the real one's, which it is
// linked with. Tests name it in HFR_OPENCL_LIBRARY. It counts from the newest context on.
//   HFR_FAIL_ENQUEUE=N   the N-th launch of a kernel and all later calls on queues: the device is lost
//   HFR_FAIL_BUFFER=N    the N-th buffer and all later ones: out of memory
//   HFR_FAIL_GROWTH=N    the same, of the buffers that are made once a round has begun
//   HFR_FAIL_BUILD=1     no program compiles
//   HFR_FAIL_ROUNDING=1  a product and a sum are fused, against what the source says
//   HFR_FAIL_FP64=1      no device has 64-bit floating point
//   HFR_FAIL_MEMORY=N    every device has N bytes of memory
//   HFR_PRETEND_GPU=1    every device says that it is a GPU, so that --device auto takes it
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <dlfcn.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

long setting(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::atol(text) : 0;
}

template <class F>
F real(F, const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

std::atomic<long> n_launches{0}, n_buffers{0}, n_growths{0};
std::atomic<bool> round_has_begun{false};

bool is_lost() {
  const long limit = setting("HFR_FAIL_ENQUEUE");
  return limit > 0 && n_launches >= limit;
}

}  // namespace

#define REAL(name) real(&name, #name)

extern "C" {

cl_context clCreateContext(const cl_context_properties* properties, cl_uint n, const cl_device_id* devices,
                           void (*notify)(const char*, const void*, size_t, void*), void* user,
                           cl_int* error) {
  n_launches = n_buffers = n_growths = 0;
  round_has_begun = false;
  return REAL(clCreateContext)(properties, n, devices, notify, user, error);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* offset, const size_t* global, const size_t* local, cl_uint n_wait,
                              const cl_event* wait, cl_event* event) {
  ++n_launches;
  if (is_lost()) return CL_OUT_OF_RESOURCES;
  char name[64] = "";
  REAL(clGetKernelInfo)(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, nullptr);
  if (std::strcmp(name, "list_cells") == 0) round_has_begun = true;
  return REAL(clEnqueueNDRangeKernel)(queue, kernel, dimensions, offset, global, local, n_wait, wait, event);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset,
                           size_t size, void* to, cl_uint n_wait, const cl_event* wait, cl_event* event) {
  if (is_lost()) return CL_OUT_OF_RESOURCES;
  return REAL(clEnqueueReadBuffer)(queue, buffer, blocking, offset, size, to, n_wait, wait, event);
}

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error) {
  const long limit = setting("HFR_FAIL_BUFFER");
  const long growth_limit = round_has_begun ? setting("HFR_FAIL_GROWTH") : 0;
  if ((limit > 0 && ++n_buffers >= limit) || (growth_limit > 0 && ++n_growths >= growth_limit)) {
    if (error) *error = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    return nullptr;
  }
  return REAL(clCreateBuffer)(context, flags, size, host, error);
}

cl_program clCreateProgramWithSource(cl_context context, cl_uint n, const char** texts, const size_t* sizes,
                                     cl_int* error) {
  if (setting("HFR_FAIL_ROUNDING") <= 0)
    return REAL(clCreateProgramWithSource)(context, n, texts, sizes, error);
  std::string source;
  for (cl_uint i = 0; i < n; ++i)
    source.append(texts[i], sizes && sizes[i] > 0 ? sizes[i] : std::strlen(texts[i]));
  const std::string exact = "(a.x * b.x + a.y * b.y)";
  const std::size_t at = source.find(exact);
  if (at != std::string::npos) source.replace(at, exact.size(), "fma(a.x, b.x, a.y * b.y)");
  const char* text = source.c_str();
  const size_t size = source.size();
  return REAL(clCreateProgramWithSource)(context, 1, &text, &size, error);
}

cl_int clBuildProgram(cl_program program, cl_uint n_devices, const cl_device_id* devices, const char* options,
                      void (*notify)(cl_program, void*), void* user) {
  if (setting("HFR_FAIL_BUILD") > 0) options = "-Dget_global_id=no_such_word";
  return REAL(clBuildProgram)(program, n_devices, devices, options, notify, user);
}

cl_int clGetDeviceInfo(cl_device_id device, cl_device_info name, size_t room, void* value, size_t* size) {
  const cl_int error = REAL(clGetDeviceInfo)(device, name, room, value, size);
  if (!value || error != CL_SUCCESS) return error;
  if (name == CL_DEVICE_DOUBLE_FP_CONFIG && setting("HFR_FAIL_FP64") > 0) std::memset(value, 0, room);
  if (name == CL_DEVICE_TYPE && setting("HFR_PRETEND_GPU") > 0) {
    const cl_device_type gpu = CL_DEVICE_TYPE_GPU;
    std::memcpy(value, &gpu, sizeof gpu);
  }
  if (name == CL_DEVICE_GLOBAL_MEM_SIZE && setting("HFR_FAIL_MEMORY") > 0) {
    const cl_ulong bytes = static_cast<cl_ulong>(setting("HFR_FAIL_MEMORY"));
    std::memcpy(value, &bytes, sizeof bytes);
  }
  return error;
}

}  // extern "C"
