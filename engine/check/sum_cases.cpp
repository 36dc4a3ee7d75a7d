// Operation `sum`. No gradient.
#include <fmt/core.h>

#include <cmath>
#include <numeric>

#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"
#include "engine/ops/sum.h"

namespace touchtrace {
namespace {

OperationCase sum_case(std::size_t size) {
  OperationCase c;
  c.shape = fmt::format("{} values", size);
  c.input_sizes = {size};
  c.terms = static_cast<double>(size);
  c.reference = [](const Arrays& in) {
    return Arrays{{std::accumulate(in[0].begin(), in[0].end(), 0.0)}};
  };
  c.forward = [](Runtime& runtime, const Arrays& in) {
    const auto total = runtime.allocate<float>(1);
    sum(runtime, upload(runtime, in[0]), total).enqueue(runtime);
    return Arrays{download(runtime, total)};
  };
  // The model's losses are not negative, so nothing cancels.
  c.prepare = [](Arrays& in) {
    for (double& value : in[0]) value = std::abs(value);
  };
  return c;
}

}  // namespace

Operation sum_operation() { return {"sum", {sum_case(3), sum_case(1), sum_case(648)}}; }

}  // namespace touchtrace
