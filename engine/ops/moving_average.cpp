#include "engine/ops/moving_average.h"

#include <algorithm>

namespace touchtrace {
namespace {

constexpr cl_uint rate_argument = 1;

}  // namespace

Launch moving_average(Runtime& runtime, const Buffer<float>& values, const Buffer<float>& average) {
  const double size = static_cast<double>(values.size());
  return Launch(runtime.kernel({"common.clh", "moving_average.cl"}, "moving_average"),
                range(static_cast<int>(values.size())), values, 0.0f, average)
      .with_cost(3.0 * size, 12.0 * size)
      .with_purpose(Purpose::optimiser);
}

void set_moving_average_rate(Launch& launch, int count, int length) {
  launch.set(rate_argument, 1.0f / static_cast<float>(std::min(count, length)));
}

}  // namespace touchtrace
