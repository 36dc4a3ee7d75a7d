#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
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

/// Category of a launch in profiles. Roll-outs count as `rollout` in both directions.
enum class Purpose {
  data_movement,  ///< layout changes, reductions of partial sums
  forward,
  rollout,
  loss,
  data_gradient,
  weight_gradient,
  optimiser
};
/// "data movement", "weight gradient", ...
std::string name_of(Purpose purpose);

/// Cost of one execution of a launch.
struct LaunchCost {
  double flops = 0.0;  ///< floating-point additions and multiplications
  double bytes = 0.0;  ///< sizes of the arrays read or written, each counted once
};

/// Kernel with arguments and global size, enqueued any number of times. Keeps its buffers alive.
/// enqueue() throws device_error if the program does not compile or the device rejects the launch.
/// Copies made after the first enqueue() share the cl_kernel: set() on one affects both.
/// Not thread-safe.
class Launch {
 public:
  using Argument = std::variant<cl_int, cl_uint, cl_float, cl::Buffer>;

  template <class... Arguments>
  Launch(Kernel kernel, cl::NDRange global, const Arguments&... arguments)
      : kernel_(std::move(kernel)), global_(global), arguments_{argument(arguments)...} {}

  template <class T>
  void set(cl_uint index, const T& value) {
    arguments_.at(index) = argument(value);
    if (created_()) set_created(index);
  }

  void enqueue(Runtime& runtime) const;

  /// Makes the global size count work-groups: multiplies dimension 0 by `local_size`; the local
  /// size becomes (local_size, 1, 1). Default: 1 on CPUs, else the driver's choice. Kernels with a
  /// reqd_work_group_size need it.
  Launch with_local_size(std::size_t local_size) &&;
  /// Sets the cost; default: no operations and the sizes of all buffers.
  Launch with_cost(const LaunchCost& cost) && {
    cost_ = cost;
    return std::move(*this);
  }
  Launch with_cost(double flops, double bytes) && {
    return std::move(*this).with_cost(LaunchCost{flops, bytes});
  }
  /// Sets the category in profiles; default Purpose::data_movement.
  Launch with_purpose(Purpose purpose) && {
    purpose_ = purpose;
    return std::move(*this);
  }

  Purpose purpose() const { return purpose_; }
  LaunchCost cost() const { return cost_ ? *cost_ : LaunchCost{0.0, buffer_bytes()}; }
  /// Name of the kernel.
  const std::string& name() const { return kernel_.name; }
  /// Buffer arguments, by index.
  std::map<cl_uint, cl::Buffer> buffers() const;

 private:
  static Argument argument(const Argument& value) { return value; }
  template <class T>
  static Argument argument(const Buffer<T>& buffer) {
    return buffer.handle();
  }
  void set_created(cl_uint index) const;
  double buffer_bytes() const;

  Kernel kernel_;
  cl::NDRange global_;
  std::optional<cl::NDRange> local_;
  std::vector<Argument> arguments_;  ///< keeps buffers alive, which OpenCL kernels do not
  std::optional<LaunchCost> cost_;
  Purpose purpose_ = Purpose::data_movement;
  mutable cl::Kernel created_;  ///< null until the first enqueue()
};

/// Launches in the order in which they are enqueued.
using Launches = std::vector<Launch>;

inline void append(Launches& launches, const Launches& more) {
  launches.insert(launches.end(), more.begin(), more.end());
}

inline Launches with_purpose(Launches launches, Purpose purpose) {
  for (auto& launch : launches) launch = std::move(launch).with_purpose(purpose);
  return launches;
}

inline void enqueue(Runtime& runtime, const Launches& launches) {
  for (const auto& launch : launches) launch.enqueue(runtime);
}

}  // namespace touchtrace
