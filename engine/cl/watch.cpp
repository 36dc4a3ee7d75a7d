#include "engine/cl/watch.h"

#include <algorithm>
#include <cmath>

namespace touchtrace {
namespace {

/// Nobody watches any more when this goes out of scope.
class Watch {
 public:
  Watch(Runtime& runtime, LaunchWatcher watcher) : runtime_(runtime) {
    runtime_.watch(std::move(watcher));
  }
  ~Watch() { runtime_.watch({}); }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  Runtime& runtime_;
};

/// The array as floats. Those of int32 hold small numbers, which are finite as floats too.
Buffer<float> as_floats(const cl::Buffer& buffer) {
  return {buffer, buffer.getInfo<CL_MEM_SIZE>() / sizeof(float)};
}

void zero_what_is_not_finite(Runtime& runtime, const cl::Buffer& buffer) {
  auto values = runtime.download(as_floats(buffer));
  std::ranges::replace_if(
      values, [](float v) { return !std::isfinite(v); }, 0.0f);
  runtime.write<float>(as_floats(buffer), values);
}

bool all_finite(Runtime& runtime, const Launch& launch) {
  return std::ranges::all_of(launch.buffers(), [&](const auto& argument) {
    const auto values = runtime.download(as_floats(argument.second));
    return std::ranges::all_of(values, [](float v) { return std::isfinite(v); });
  });
}

}  // namespace

void visit_launches(Runtime& runtime, const std::function<void()>& pass,
                    const std::function<void(const Launch&)>& visit) {
  const Watch watch(runtime, [&](const Launch& launch) {
    runtime.finish();  // both queues
    visit(launch);
  });
  pass();
}

std::string first_not_finite(Runtime& runtime, const std::function<void()>& pass) {
  std::map<cl_mem, cl::Buffer> buffers;
  visit_launches(runtime, pass, [&](const Launch& launch) {
    for (const auto& [index, buffer] : launch.buffers()) buffers.emplace(buffer(), buffer);
  });
  for (const auto& [handle, buffer] : buffers) zero_what_is_not_finite(runtime, buffer);
  std::string first;
  visit_launches(runtime, pass, [&](const Launch& launch) {
    if (first.empty() && !all_finite(runtime, launch)) first = launch.name();
  });
  return first;
}

}  // namespace touchtrace
