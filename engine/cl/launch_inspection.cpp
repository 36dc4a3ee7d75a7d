#include "engine/cl/launch_inspection.h"

#include <algorithm>
#include <cmath>

#include "engine/base/finite.h"

namespace touchtrace {
namespace {

/// Sets the runtime's launch observer, and removes it in the destructor.
class ScopedObserver {
 public:
  ScopedObserver(Runtime& runtime, LaunchObserver observer) : runtime_(runtime) {
    runtime_.set_launch_observer(std::move(observer));
  }
  ~ScopedObserver() { runtime_.set_launch_observer({}); }
  ScopedObserver(const ScopedObserver&) = delete;
  ScopedObserver& operator=(const ScopedObserver&) = delete;

 private:
  Runtime& runtime_;
};

/// The buffer as floats. int32 buffers hold small numbers, which are finite as floats, too.
Buffer<float> as_floats(const cl::Buffer& buffer) {
  return {buffer, buffer.getInfo<CL_MEM_SIZE>() / sizeof(float)};
}

void zero_non_finite_values(Runtime& runtime, const cl::Buffer& buffer) {
  auto values = runtime.download(as_floats(buffer));
  std::ranges::replace_if(
      values, [](float v) { return !std::isfinite(v); }, 0.0f);
  runtime.write<float>(as_floats(buffer), values);
}

bool has_finite_buffers(Runtime& runtime, const Launch& launch) {
  return std::ranges::all_of(launch.buffers(), [&](const auto& argument) {
    return all_finite(runtime.download(as_floats(argument.second)));
  });
}

}  // namespace

void visit_launches(Runtime& runtime, const std::function<void()>& pass,
                    const std::function<void(const Launch&)>& visit) {
  const ScopedObserver observer(runtime, [&](const Launch& launch) {
    runtime.finish();  // both queues
    visit(launch);
  });
  pass();
}

std::string first_non_finite_kernel(Runtime& runtime, const std::function<void()>& pass) {
  std::map<cl_mem, cl::Buffer> buffers;
  visit_launches(runtime, pass, [&](const Launch& launch) {
    for (const auto& [index, buffer] : launch.buffers()) buffers.emplace(buffer(), buffer);
  });
  for (const auto& [handle, buffer] : buffers) zero_non_finite_values(runtime, buffer);
  std::string first;
  visit_launches(runtime, pass, [&](const Launch& launch) {
    if (first.empty() && !has_finite_buffers(runtime, launch)) first = launch.name();
  });
  return first;
}

}  // namespace touchtrace
