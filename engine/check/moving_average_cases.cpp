// Operation `moving_average`. Inputs: values, average. Output: the new average. No gradient.
#include <fmt/core.h>

#include <algorithm>

#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"
#include "engine/ops/moving_average.h"

namespace touchtrace {
namespace {

OperationCase moving_average_case(std::size_t size, int count, int length) {
  OperationCase c;
  c.shape = fmt::format("{} values, {} of {}", size, count, length);
  c.input_sizes = {size, size};
  c.terms = 3.0;
  c.reference = [count, length](const Arrays& in) {
    std::vector<double> average = in[1];
    for (std::size_t i = 0; i < average.size(); ++i)
      average[i] += (in[0][i] - average[i]) / std::min(count, length);
    return Arrays{average};
  };
  c.forward = [count, length](Runtime& runtime, const Arrays& in) {
    const auto average = upload(runtime, in[1]);
    Launch launch = moving_average(runtime, upload(runtime, in[0]), average);
    set_moving_average_rate(launch, count, length);
    launch.enqueue(runtime);
    return Arrays{download(runtime, average)};
  };
  return c;
}

}  // namespace

Operation moving_average_operation() {
  return {"moving_average",
          {moving_average_case(16, 1, 10), moving_average_case(1, 7, 10),
           moving_average_case(1003, 500, 10)}};
}

}  // namespace touchtrace
