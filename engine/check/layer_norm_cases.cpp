// Operation `layer_norm`. Inputs: x, gain, bias.
#include <fmt/core.h>

#include "engine/check/host_arrays.h"
#include "engine/check/layer_norm_reference.h"
#include "engine/check/rows.h"
#include "engine/ops/layer_norm.h"

namespace touchtrace {
namespace {

/// Arrays on the device after the forward pass.
LayerNormArrays normalized(Runtime& runtime, const Arrays& in) {
  const int columns = static_cast<int>(in[1].size()),
            rows = static_cast<int>(in[0].size()) / columns;
  LayerNormArrays arrays{.rows = rows,
                         .columns = columns,
                         .parameters = upload(runtime, joined(in[1], in[2])),
                         .gain_at = 0,
                         .bias_at = columns,
                         .x = upload(runtime, in[0]),
                         .y = runtime.allocate<float>(in[0].size()),
                         .statistics = runtime.allocate<float>(2 * std::size_t(rows))};
  layer_norm(runtime, arrays).enqueue(runtime);
  return arrays;
}

Arrays backward(Runtime& runtime, const Arrays& in, const Arrays& grads) {
  const auto arrays = normalized(runtime, in);
  const auto grad_y = upload(runtime, grads[0]), grad_x = runtime.allocate<float>(in[0].size());
  const auto gradient = runtime.allocate<float>(2 * in[1].size());
  enqueue(runtime, {layer_norm_backward(runtime, arrays, grad_y, grad_x),
                    layer_norm_weights(runtime, arrays, grad_y, gradient)});
  const auto [gain, bias] = split(download(runtime, gradient), in[1].size());
  return {download(runtime, grad_x), gain, bias};
}

OperationCase layer_norm_case(int rows, int columns) {
  OperationCase c;
  c.shape = fmt::format("{} rows of {}", rows, columns);
  c.input_sizes = {std::size_t(rows) * columns, std::size_t(columns), std::size_t(columns)};
  c.terms = columns;
  c.reference = [](const Arrays& in) { return Arrays{layer_norm_reference(in[0], in[1], in[2])}; };
  c.forward = [](Runtime& runtime, const Arrays& in) {
    return Arrays{download(runtime, normalized(runtime, in).y)};
  };
  c.reference_backward = [](const Arrays& in, const Arrays& grads) {
    auto grad = layer_norm_backward_reference(in[0], in[1], grads[0]);
    return Arrays{grad.x, grad.gain, grad.bias};
  };
  c.backward = [](Runtime& runtime, const Arrays& in, const Arrays& grads) {
    return backward(runtime, in, grads);
  };
  return c;
}

}  // namespace

Operation layer_norm_operation() {
  return {"layer_norm",
          {layer_norm_case(3, 16), layer_norm_case(160, 64), layer_norm_case(1, 64),
           layer_norm_case(7, 240)},
          1,
          true};
}

}  // namespace touchtrace
