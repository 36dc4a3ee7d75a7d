// Operation `adam`. Inputs: parameters, gradient, both moments, decay. Outputs: change of the
// parameters, both moments after the update. No gradient.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"
#include "engine/ops/adam.h"

namespace touchtrace {
namespace {

Arrays reference(const AdamStep& step, const Arrays& in) {
  double squares = 0.0;
  for (double g : in[1]) squares += g * g;
  const double clip = std::min(1.0, step.clip_norm / (std::sqrt(squares) + 1e-6));
  Arrays out{in[0], in[2], in[3]};
  for (std::size_t i = 0; i < in[0].size(); ++i) {
    const double g = clip * in[1][i];
    const double m = out[1][i] = 0.9 * in[2][i] + 0.1 * g;
    const double v = out[2][i] = 0.999 * in[3][i] + 0.001 * g * g;
    const double direction = m / (1 - std::pow(0.9, step.count)) /
                             (std::sqrt(v / (1 - std::pow(0.999, step.count))) + 1e-8);
    out[0][i] = -step.learning_rate * (direction + in[4][i] * in[0][i]);
  }
  return out;
}

Arrays forward(Runtime& runtime, const AdamStep& step, const Arrays& in) {
  const auto parameters = upload(runtime, in[0]), loss = upload(runtime, {1.0});
  Adam adam(runtime, parameters, upload(runtime, in[1]), upload(runtime, in[4]), loss);
  const auto write = [&](const Buffer<float>& buffer, const std::vector<double>& values) {
    runtime.write<float>(buffer, std::vector<float>(values.begin(), values.end()));
  };
  write(adam.first_moment(), in[2]);
  write(adam.second_moment(), in[3]);
  adam.enqueue(step);
  auto change = download(runtime, parameters);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= in[0][i];
  return {change, download(runtime, adam.first_moment()), download(runtime, adam.second_moment())};
}

OperationCase adam_case(std::size_t size, const AdamStep& step) {
  OperationCase c;
  c.shape =
      fmt::format("{} parameters, update {}, clipped to {}", size, step.count, step.clip_norm);
  c.input_sizes = std::vector<std::size_t>(5, size);
  // 17 operations per parameter, and the norm of the gradient, summed in chunks of at most 1024.
  c.terms = 17.0 + std::min(1024.0, double(size)) + double(size) / 1024.0;
  c.reference = [step](const Arrays& in) { return reference(step, in); };
  c.forward = [step](Runtime& runtime, const Arrays& in) { return forward(runtime, step, in); };
  // Parameters as small as a step, so that their rounding does not hide it; decay so large that it
  // contributes as much as the gradient.
  c.prepare = [step](Arrays& in) {
    for (std::size_t input : {3, 4})
      for (double& value : in[input]) value = std::abs(value);
    for (double& value : in[0]) value = static_cast<float>(value * step.learning_rate);
    for (double& value : in[4]) value = static_cast<float>(value / step.learning_rate);
  };
  return c;
}

}  // namespace

Operation adam_operation() {
  return {"adam",
          {adam_case(16, {1, 1e-3, 1.0}), adam_case(1, {1, 2e-3, 100.0}),
           adam_case(100'003, {17, 2e-3, 1.0}), adam_case(4096, {3000, 1e-5, 1e6})},
          1,
          true};
}

}  // namespace touchtrace
