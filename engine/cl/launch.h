#pragma once

#include <map>
#include <utility>
#include <vector>

#include "engine/cl/runtime.h"

namespace touchtrace {

/// Global sizes of a launch.
inline cl::NDRange range(int x) { return cl::NDRange(static_cast<std::size_t>(x)); }
inline cl::NDRange range(int x, int y) {
  return cl::NDRange(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
}
inline cl::NDRange range(int x, int y, int z) {
  return cl::NDRange(static_cast<std::size_t>(x), static_cast<std::size_t>(y),
                     static_cast<std::size_t>(z));
}

/// A kernel with its arguments, to be queued again and again: what a plan is made of. Kernels
/// compute one tile a work-item without barriers.
class Launch {
 public:
  template <class... Arguments>
  Launch(cl::Kernel kernel, cl::NDRange global, const Arguments&... arguments)
      : kernel_(std::move(kernel)), global_(global) {
    cl_uint index = 0;
    (set(index++, arguments), ...);
  }

  void set(cl_uint index, cl_int value) { kernel_.setArg(index, value); }
  void set(cl_uint index, cl_uint value) { kernel_.setArg(index, value); }
  void set(cl_uint index, cl_float value) { kernel_.setArg(index, value); }
  void set(cl_uint index, const cl::Buffer& buffer) {
    kernel_.setArg(index, buffer);
    buffers_[index] = buffer;
  }
  template <class T>
  void set(cl_uint index, const Buffer<T>& buffer) {
    set(index, buffer.handle());
  }

  void enqueue(Runtime& runtime) const {
    runtime.launch(kernel_, global_);
    if (runtime.watcher()) runtime.watcher()(*this);
  }

  /// The kernel's.
  std::string name() const { return kernel_.getInfo<CL_KERNEL_FUNCTION_NAME>(); }
  /// The arguments that are arrays, by their index.
  const std::map<cl_uint, cl::Buffer>& buffers() const { return buffers_; }

 private:
  cl::Kernel kernel_;
  cl::NDRange global_;
  std::map<cl_uint, cl::Buffer> buffers_;  ///< kept alive: OpenCL's kernel arguments do not
};

/// Launches in their order.
using Launches = std::vector<Launch>;

inline void enqueue(Runtime& runtime, const Launches& launches) {
  for (const auto& launch : launches) launch.enqueue(runtime);
}

}  // namespace touchtrace
