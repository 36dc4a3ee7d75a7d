#include "engine/ops/layer_norm.h"

#include "engine/base/integer_math.h"

namespace touchtrace {
namespace {

/// Rows of a work-group, and work-items of a row (kernels/layer_norm_gpu.cl).
constexpr int gpu_lanes = 16;

bool on_gpu(const Runtime& runtime) { return runtime.kernel_variant() == KernelVariant::gpu; }

/// `items`: rows, or vectors of 16 columns. On GPUs, rows are shared by 16 work-items.
Launch layer_norm_launch(Runtime& runtime, const LayerNormArrays& a, const std::string& pass,
                         int items, const auto&... arguments) {
  const std::string name = on_gpu(runtime) ? "layer_norm_gpu" : "layer_norm";
  Launch launch(runtime.kernel({"common.clh", name + ".cl"}, name + pass,
                               {{"COLUMNS", std::to_string(a.columns)}}),
                range(items), arguments...);
  return on_gpu(runtime) ? std::move(launch).with_local_size(gpu_lanes * gpu_lanes) : launch;
}

/// A launch over rows. The GPU variant is told their number.
Launch row_launch(Runtime& runtime, const LayerNormArrays& a, const std::string& pass,
                  const auto&... arguments) {
  if (on_gpu(runtime))
    return layer_norm_launch(runtime, a, pass, ceil_div(a.rows, gpu_lanes), arguments..., a.rows);
  return layer_norm_launch(runtime, a, pass, a.rows, arguments...);
}

double value_count(const LayerNormArrays& a) { return 1.0 * a.rows * a.columns; }

}  // namespace

Launch layer_norm(Runtime& runtime, const LayerNormArrays& a) {
  return row_launch(runtime, a, "", a.x, a.parameters, a.gain_at, a.bias_at, a.y, a.statistics)
      .with_cost(7.0 * value_count(a), 8.0 * value_count(a))
      .with_purpose(Purpose::forward);
}

Launch layer_norm_backward(Runtime& runtime, const LayerNormArrays& a, const Buffer<float>& grad_y,
                           const Buffer<float>& grad_x) {
  return row_launch(runtime, a, "_backward", grad_y, a.x, a.statistics, a.parameters, a.gain_at,
                    grad_x)
      .with_cost(12.0 * value_count(a), 12.0 * value_count(a))
      .with_purpose(Purpose::data_gradient);
}

Launch layer_norm_weights(Runtime& runtime, const LayerNormArrays& a, const Buffer<float>& grad_y,
                          const Buffer<float>& gradient) {
  return layer_norm_launch(runtime, a, "_weights", a.columns / 16, grad_y, a.x, a.statistics,
                           a.rows, gradient, a.gain_at, a.bias_at)
      .with_cost(5.0 * value_count(a), 8.0 * value_count(a))
      .with_purpose(Purpose::weight_gradient);
}

}  // namespace touchtrace
