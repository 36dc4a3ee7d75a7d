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

/// What a launch does in a training update. Roll-outs go both ways.
enum class Purpose {
  moves_and_sums,  ///< data between layouts, sums of parts
  forward,
  rollout,
  loss,
  data_gradient,
  weights_gradient,
  optimiser
};
/// "moves and sums", "data gradient" and so on.
std::string name_of(Purpose purpose);

/// What one turn of a launch costs.
struct LaunchCost {
  double flops = 0.0;  ///< floating-point operations of sums and products;
                       ///< 0 where only data are moved
  double bytes = 0.0;  ///< of arrays read and written, each once
};

/// A kernel with its arguments, to be queued again and again: what a plan is made of. Its range
/// counts work-items that know nothing of each other, or with in_groups_of work-groups.
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

  /// The same launch, with a work-group of `items` in the place of each item of its range.
  Launch in_groups_of(std::size_t items) &&;
  /// The same launch, which says what it costs.
  Launch costing(const LaunchCost& cost) && {
    cost_ = cost;
    return std::move(*this);
  }
  Launch costing(double flops, double bytes) && {
    return std::move(*this).costing(LaunchCost{flops, bytes});
  }
  /// The same launch, which says whether it was tuned for the device.
  Launch tuned(bool is_tuned) && {
    is_tuned_ = is_tuned;
    return std::move(*this);
  }
  bool is_tuned() const { return is_tuned_; }
  /// The same launch, which says what it does; else it moves or sums.
  Launch serving(Purpose purpose) && {
    purpose_ = purpose;
    return std::move(*this);
  }
  Purpose purpose() const { return purpose_; }
  /// As said by costing(); else the bytes of all its arrays.
  LaunchCost cost() const { return cost_ ? *cost_ : LaunchCost{0.0, bytes_of_arrays()}; }

  /// Of the range: where kernels compute a tile an item, each stays on one core.
  std::size_t items() const;
  /// The kernel's.
  const std::string& name() const { return kernel_.name; }
  /// The arguments that are arrays, by their index.
  std::map<cl_uint, cl::Buffer> buffers() const;

 private:
  static Argument argument(const Argument& value) { return value; }
  template <class T>
  static Argument argument(const Buffer<T>& buffer) {
    return buffer.handle();
  }
  void set_created(cl_uint index) const;
  double bytes_of_arrays() const;

  Kernel kernel_;
  cl::NDRange global_;
  std::optional<cl::NDRange> local_;
  std::vector<Argument> arguments_;  ///< keeps buffers alive: OpenCL's kernel arguments do not
  std::optional<LaunchCost> cost_;
  bool is_tuned_ = false;
  Purpose purpose_ = Purpose::moves_and_sums;
  mutable cl::Kernel created_;  ///< null until the first turn
};

/// Launches in their order.
using Launches = std::vector<Launch>;

inline void append(Launches& launches, const Launches& more) {
  launches.insert(launches.end(), more.begin(), more.end());
}

inline void enqueue(Runtime& runtime, const Launches& launches) {
  for (const auto& launch : launches) launch.enqueue(runtime);
}

}  // namespace touchtrace
