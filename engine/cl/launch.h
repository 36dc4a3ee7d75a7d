#pragma once

#include <map>
#include <optional>
#include <string>
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

/// What one turn of a launch costs.
struct LaunchCost {
  double flops = 0.0;  ///< floating-point operations of sums and products;
                       ///< 0 where only data are moved
  double bytes = 0.0;  ///< of arrays read and written, each once
};

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

  /// The same launch, which says what it costs.
  Launch costing(const LaunchCost& cost) && {
    cost_ = cost;
    return std::move(*this);
  }
  Launch costing(double flops, double bytes) && {
    return std::move(*this).costing(LaunchCost{flops, bytes});
  }
  /// As said by costing(); else the bytes of all its arrays.
  LaunchCost cost() const { return cost_ ? *cost_ : LaunchCost{0.0, bytes_of_arrays()}; }

  /// The kernel's.
  std::string name() const { return kernel_.getInfo<CL_KERNEL_FUNCTION_NAME>(); }
  /// The arguments that are arrays, by their index.
  const std::map<cl_uint, cl::Buffer>& buffers() const { return buffers_; }

 private:
  double bytes_of_arrays() const {
    std::map<cl_mem, double> bytes;
    for (const auto& [index, buffer] : buffers_)
      bytes[buffer()] = static_cast<double>(buffer.getInfo<CL_MEM_SIZE>());
    double sum = 0.0;
    for (const auto& [handle, size] : bytes) sum += size;
    return sum;
  }

  cl::Kernel kernel_;
  cl::NDRange global_;
  std::optional<LaunchCost> cost_;
  std::map<cl_uint, cl::Buffer> buffers_;  ///< kept alive: OpenCL's kernel arguments do not
};

/// Launches in their order.
using Launches = std::vector<Launch>;

inline void enqueue(Runtime& runtime, const Launches& launches) {
  for (const auto& launch : launches) launch.enqueue(runtime);
}

}  // namespace touchtrace
