// PoCL whose device disappears after VANISHES_AFTER launches: later launches return
// CL_DEVICE_NOT_AVAILABLE. Loads PoCL and replaces one entry of its dispatch table.
#include <CL/cl_icd.h>
#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace {

decltype(cl_icd_dispatch::clEnqueueNDRangeKernel) original_launch;
std::atomic<long> launches_left;

cl_int launch(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
              const std::size_t* offset, const std::size_t* global, const std::size_t* local,
              cl_uint count, const cl_event* waits, cl_event* event) {
  if (launches_left-- <= 0) return CL_DEVICE_NOT_AVAILABLE;
  return original_launch(queue, kernel, dimensions, offset, global, local, count, waits, event);
}

void* pocl_function(const char* name) {
  static void* const library = dlopen("libpocl.so.2", RTLD_NOW | RTLD_LOCAL);
  return library ? dlsym(library, name) : nullptr;
}

/// Replaces the launch function in the dispatch table, a pointer to which is the first member of
/// every object. The table may be in read-only memory.
void replace_launch(cl_platform_id platform) {
  auto* const table = *reinterpret_cast<cl_icd_dispatch**>(platform);
  if (table->clEnqueueNDRangeKernel == launch) return;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(table) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(table + 1);
  mprotect(reinterpret_cast<void*>(begin), end - begin, PROT_READ | PROT_WRITE);
  original_launch = table->clEnqueueNDRangeKernel;
  table->clEnqueueNDRangeKernel = launch;
  launches_left = std::atol(std::getenv("VANISHES_AFTER"));
}

}  // namespace

extern "C" {

void* clGetExtensionFunctionAddress(const char* name);

cl_int clIcdGetPlatformIDsKHR(cl_uint capacity, cl_platform_id* to, cl_uint* count) {
  using Function = decltype(&clIcdGetPlatformIDsKHR);
  const auto extension = reinterpret_cast<decltype(&clGetExtensionFunctionAddress)>(
      pocl_function("clGetExtensionFunctionAddress"));
  const auto all = reinterpret_cast<Function>(extension("clIcdGetPlatformIDsKHR"));
  const cl_int error = all(capacity, to, count);
  if (error == CL_SUCCESS && to && capacity > 0) replace_launch(*to);
  return error;
}

cl_int clGetPlatformInfo(cl_platform_id id, cl_platform_info what, std::size_t capacity, void* to,
                         std::size_t* needed) {
  using Function = decltype(&clGetPlatformInfo);
  static const auto info = reinterpret_cast<Function>(pocl_function("clGetPlatformInfo"));
  if (info) return info(id, what, capacity, to, needed);
  return (*reinterpret_cast<cl_icd_dispatch**>(id))
      ->clGetPlatformInfo(id, what, capacity, to, needed);
}

void* clGetExtensionFunctionAddress(const char* name) {
  if (std::string_view(name) == "clIcdGetPlatformIDsKHR")
    return reinterpret_cast<void*>(&clIcdGetPlatformIDsKHR);
  if (std::string_view(name) == "clGetPlatformInfo")
    return reinterpret_cast<void*>(&clGetPlatformInfo);
  return nullptr;
}
}
