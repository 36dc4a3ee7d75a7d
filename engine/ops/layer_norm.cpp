#include "engine/ops/layer_norm.h"

namespace touchtrace {
namespace {

Kernel layer_norm_kernel(Runtime& runtime, const char* name, int columns) {
  return runtime.kernel({"common.clh", "layer_norm.cl"}, name,
                        {{"COLUMNS", std::to_string(columns)}});
}

double value_count(const LayerNormArrays& a) { return 1.0 * a.rows * a.columns; }

}  // namespace

Launch layer_norm(Runtime& runtime, const LayerNormArrays& a) {
  return Launch(layer_norm_kernel(runtime, "layer_norm", a.columns), range(a.rows), a.x,
                a.parameters, a.gain_at, a.bias_at, a.y, a.statistics)
      .with_cost(7.0 * value_count(a), 8.0 * value_count(a))
      .with_purpose(Purpose::forward);
}

Launch layer_norm_backward(Runtime& runtime, const LayerNormArrays& a, const Buffer<float>& grad_y,
                           const Buffer<float>& grad_x) {
  return Launch(layer_norm_kernel(runtime, "layer_norm_backward", a.columns), range(a.rows), grad_y,
                a.x, a.statistics, a.parameters, a.gain_at, grad_x)
      .with_cost(12.0 * value_count(a), 12.0 * value_count(a))
      .with_purpose(Purpose::data_gradient);
}

Launch layer_norm_weights(Runtime& runtime, const LayerNormArrays& a, const Buffer<float>& grad_y,
                          const Buffer<float>& gradient) {
  return Launch(layer_norm_kernel(runtime, "layer_norm_weights", a.columns), range(a.columns / 16),
                grad_y, a.x, a.statistics, a.rows, gradient, a.gain_at, a.bias_at)
      .with_cost(5.0 * value_count(a), 8.0 * value_count(a))
      .with_purpose(Purpose::weight_gradient);
}

}  // namespace touchtrace
