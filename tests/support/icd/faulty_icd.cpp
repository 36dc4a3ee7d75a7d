// OpenCL driver of one fake GPU that lists a device and builds every program, but cannot compute.
// Environment variable FAULTY_ICD:
//
//   lies      launches succeed without computing anything
//   crashes   the first launch aborts
//   hangs     launches never return
//   unlisted  listing the devices aborts
//
// Implements only the functions that touchtrace calls.
#include <CL/cl_icd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace {

cl_icd_dispatch table{};

/// OpenCL object of any type; the ICD loader expects the dispatch table as its first member.
struct Object {
  cl_icd_dispatch* dispatch = &table;
  std::vector<char> bytes;
  std::string name;
  int references = 1;  ///< of buffers and kernels; the other objects are static
  std::function<void()> on_release;
};

Object platform, device, context, queue, program, event;

template <class Handle>
Handle as(Object& object) {
  return reinterpret_cast<Handle>(&object);
}

template <class Handle>
cl_int retain(Handle handle) {
  ++reinterpret_cast<Object*>(handle)->references;
  return CL_SUCCESS;
}

template <class Handle>
cl_int release(Handle handle) {
  auto* object = reinterpret_cast<Object*>(handle);
  if (--object->references > 0) return CL_SUCCESS;
  if (object->on_release) object->on_release();
  delete object;
  return CL_SUCCESS;
}

bool has_fault(const char* fault) {
  const char* mode = std::getenv("FAULTY_ICD");
  return mode && std::strcmp(mode, fault) == 0;
}

cl_int return_bytes(const void* value, std::size_t size, std::size_t capacity, void* to,
                    std::size_t* needed) {
  if (needed) *needed = size;
  if (to) std::memcpy(to, value, std::min(size, capacity));
  return CL_SUCCESS;
}

cl_int return_bytes(const std::string& text, std::size_t capacity, void* to, std::size_t* needed) {
  return return_bytes(text.c_str(), text.size() + 1, capacity, to, needed);
}

template <class T>
cl_int return_value(T value, std::size_t capacity, void* to, std::size_t* needed) {
  return return_bytes(&value, sizeof value, capacity, to, needed);
}

cl_int platform_info(cl_platform_id, cl_platform_info what, std::size_t capacity, void* to,
                     std::size_t* needed) {
  if (what == CL_PLATFORM_VERSION) return return_bytes("OpenCL 1.2 faulty", capacity, to, needed);
  if (what == CL_PLATFORM_EXTENSIONS) return return_bytes("cl_khr_icd", capacity, to, needed);
  if (what == CL_PLATFORM_ICD_SUFFIX_KHR) return return_bytes("FAULTY", capacity, to, needed);
  return return_bytes("Faulty platform", capacity, to, needed);
}

cl_int device_ids(cl_platform_id, cl_device_type, cl_uint capacity, cl_device_id* to,
                  cl_uint* count) {
  if (has_fault("unlisted")) std::abort();
  if (count) *count = 1;
  if (to && capacity > 0) *to = as<cl_device_id>(device);
  return CL_SUCCESS;
}

cl_int device_info(cl_device_id, cl_device_info what, std::size_t capacity, void* to,
                   std::size_t* needed) {
  switch (what) {
    case CL_DEVICE_TYPE:
      return return_value<cl_device_type>(CL_DEVICE_TYPE_GPU, capacity, to, needed);
    case CL_DEVICE_PLATFORM:
      return return_value(as<cl_platform_id>(platform), capacity, to, needed);
    case CL_DEVICE_MAX_COMPUTE_UNITS:
      return return_value<cl_uint>(64, capacity, to, needed);
    case CL_DEVICE_GLOBAL_MEM_SIZE:
      return return_value<cl_ulong>(1ull << 33, capacity, to, needed);
    case CL_DEVICE_DOUBLE_FP_CONFIG:
      return return_value<cl_device_fp_config>(0, capacity, to, needed);
    case CL_DEVICE_VERSION:
      return return_bytes("OpenCL 1.2 faulty", capacity, to, needed);
    default:
      return return_bytes("Faulty 3000", capacity, to, needed);
  }
}

template <class... Arguments>
cl_int succeed(Arguments...) {
  return CL_SUCCESS;
}

cl_context create_context(const cl_context_properties*, cl_uint, const cl_device_id*,
                          void(CL_CALLBACK*)(const char*, const void*, std::size_t, void*), void*,
                          cl_int* error) {
  if (error) *error = CL_SUCCESS;
  return as<cl_context>(context);
}

cl_command_queue create_queue(cl_context, cl_device_id, cl_command_queue_properties,
                              cl_int* error) {
  if (error) *error = CL_SUCCESS;
  return as<cl_command_queue>(queue);
}

cl_mem create_buffer(cl_context, cl_mem_flags, std::size_t size, void*, cl_int* error) {
  if (error) *error = CL_SUCCESS;
  auto* buffer = new Object;
  buffer->bytes.resize(size);
  return as<cl_mem>(*buffer);
}

cl_int set_destructor_callback(cl_mem buffer, void(CL_CALLBACK* call)(cl_mem, void*), void* data) {
  reinterpret_cast<Object*>(buffer)->on_release = [=] { call(buffer, data); };
  return CL_SUCCESS;
}

cl_program create_program(cl_context, cl_uint, const char**, const std::size_t*, cl_int* error) {
  if (error) *error = CL_SUCCESS;
  return as<cl_program>(program);
}

cl_int program_info(cl_program, cl_program_info what, std::size_t capacity, void* to,
                    std::size_t* needed) {
  if (what == CL_PROGRAM_NUM_DEVICES) return return_value<cl_uint>(1, capacity, to, needed);
  return return_value(as<cl_device_id>(device), capacity, to, needed);
}

cl_int build_info(cl_program, cl_device_id, cl_program_build_info, std::size_t capacity, void* to,
                  std::size_t* needed) {
  return return_bytes("", capacity, to, needed);
}

cl_kernel create_kernel(cl_program, const char* name, cl_int* error) {
  if (error) *error = CL_SUCCESS;
  auto* kernel = new Object;
  kernel->name = name;
  return as<cl_kernel>(*kernel);
}

cl_int kernel_info(cl_kernel kernel, cl_kernel_info, std::size_t capacity, void* to,
                   std::size_t* needed) {
  return return_bytes(reinterpret_cast<Object*>(kernel)->name, capacity, to, needed);
}

char* bytes_of(cl_mem buffer) { return reinterpret_cast<Object*>(buffer)->bytes.data(); }

cl_int read_buffer(cl_command_queue, cl_mem buffer, cl_bool, std::size_t at, std::size_t size,
                   void* to, cl_uint, const cl_event*, cl_event*) {
  std::memcpy(to, bytes_of(buffer) + at, size);
  return CL_SUCCESS;
}

cl_int write_buffer(cl_command_queue, cl_mem buffer, cl_bool, std::size_t at, std::size_t size,
                    const void* from, cl_uint, const cl_event*, cl_event*) {
  std::memcpy(bytes_of(buffer) + at, from, size);
  return CL_SUCCESS;
}

cl_int launch(cl_command_queue, cl_kernel, cl_uint, const std::size_t*, const std::size_t*,
              const std::size_t*, cl_uint, const cl_event*, cl_event*) {
  if (has_fault("crashes")) std::abort();
  while (has_fault("hangs")) pause();
  return CL_SUCCESS;
}

cl_int platform_ids(cl_uint capacity, cl_platform_id* to, cl_uint* count) {
  if (count) *count = 1;
  if (to && capacity > 0) *to = as<cl_platform_id>(platform);
  return CL_SUCCESS;
}

void fill_table() {
  table.clGetPlatformInfo = platform_info;
  table.clGetDeviceIDs = device_ids;
  table.clGetDeviceInfo = device_info;
  table.clRetainDevice = succeed, table.clReleaseDevice = succeed;
  table.clCreateContext = create_context;
  table.clRetainContext = succeed, table.clReleaseContext = succeed;
  table.clCreateCommandQueue = create_queue;
  table.clRetainCommandQueue = succeed, table.clReleaseCommandQueue = succeed;
  table.clCreateBuffer = create_buffer;
  table.clRetainMemObject = retain, table.clReleaseMemObject = release;
  table.clSetMemObjectDestructorCallback = set_destructor_callback;
  table.clCreateProgramWithSource = create_program;
  table.clBuildProgram = succeed;
  table.clGetProgramInfo = program_info;
  table.clGetProgramBuildInfo = build_info;
  table.clRetainProgram = succeed, table.clReleaseProgram = succeed;
  table.clCreateKernel = create_kernel;
  table.clGetKernelInfo = kernel_info;
  table.clSetKernelArg = succeed;
  table.clRetainKernel = retain, table.clReleaseKernel = release;
  table.clEnqueueReadBuffer = read_buffer;
  table.clEnqueueWriteBuffer = write_buffer;
  table.clEnqueueFillBuffer = succeed;
  table.clEnqueueNDRangeKernel = launch;
  table.clFlush = succeed, table.clFinish = succeed;
}

}  // namespace

extern "C" {

cl_int clIcdGetPlatformIDsKHR(cl_uint capacity, cl_platform_id* to, cl_uint* count) {
  fill_table();
  return platform_ids(capacity, to, count);
}

cl_int clGetPlatformInfo(cl_platform_id id, cl_platform_info what, std::size_t capacity, void* to,
                         std::size_t* needed) {
  return platform_info(id, what, capacity, to, needed);
}

void* clGetExtensionFunctionAddress(const char* name) {
  if (std::strcmp(name, "clIcdGetPlatformIDsKHR") == 0)
    return reinterpret_cast<void*>(&clIcdGetPlatformIDsKHR);
  if (std::strcmp(name, "clGetPlatformInfo") == 0)
    return reinterpret_cast<void*>(&clGetPlatformInfo);
  return nullptr;
}
}
