#include <fmt/core.h>

#include <numeric>

#include "engine/base/random.h"
#include "engine/cl/timing.h"
#include "engine/model/model_spec.h"
#include "engine/model/tactile_encoder.h"
#include "engine/ops/conv2d.h"
#include "engine/train/verify_engine.h"

namespace touchtrace {
namespace {

Buffer<float> normal_buffer(Runtime& runtime, std::size_t size) {
  RandomStream random(1, "verify encoder");
  std::vector<float> values(size);
  for (auto& value : values) value = static_cast<float>(random.normal());
  return runtime.upload<float>(values);
}

/// Milliseconds of a forward and a backward pass over `windows` windows of the default model.
double step_ms(Runtime& runtime, int windows) {
  const ModelSpec spec;
  ParameterTable table;
  TactileEncoder encoder(runtime, "tactile", {windows, spec.window_frames, spec.rows, spec.cols},
                         true, table);
  const auto parameters = runtime.upload<float>(table.initial_values(1));
  const auto gradient = runtime.allocate_zeros<float>(table.size());
  std::vector<int> last(static_cast<std::size_t>(windows));
  std::iota(last.begin(), last.end(), spec.window_frames - 1);
  const auto last_frame = runtime.upload<int>(last);
  const auto frames = static_cast<std::size_t>(windows + spec.window_frames);
  const auto stream = normal_buffer(runtime, frames * spec.rows * spec.cols);
  const auto grad_features = normal_buffer(runtime, encoder.features().size());
  return 1e3 * median_seconds(runtime, [&] {
           encoder.forward(stream, last_frame, parameters, {0.2, 1});
           encoder.backward(grad_features, gradient);
         });
}

/// Operations and seconds of one pass, summed over layers.
struct Cost {
  double flops = 0.0, seconds = 0.0;

  void add(const Conv2dShape& shape, double more) { flops += shape.flops(), seconds += more; }
};

struct LayerCosts {
  Cost forward, data, weights;
};

void measure_layer(Runtime& runtime, const Conv2dShape& shape, LayerCosts& costs) {
  const int weight_size = shape.out_channels * shape.in_channels * 9;
  const Conv2dPlaces places{0, weight_size};
  const auto in = normal_buffer(runtime, shape.in_size()),
             out = normal_buffer(runtime, shape.out_size());
  const auto parameters =
      normal_buffer(runtime, static_cast<std::size_t>(weight_size) + shape.out_channels);
  Conv2dForward forward(runtime, shape, places, in, out);
  Conv2dBackwardWeights weights(runtime, shape, places, in, out);
  costs.forward.add(shape, median_seconds(runtime, [&] { forward.enqueue(runtime, parameters); }));
  costs.weights.add(shape, median_seconds(runtime, [&] { weights.enqueue(runtime, parameters); }));
  if (shape.in_planes) return;
  const auto grad_in = runtime.allocate_zeros<float>(shape.in_size());
  Conv2dBackwardData data(runtime, shape, places, in, out, grad_in);
  costs.data.add(shape, median_seconds(runtime, [&] { data.enqueue(runtime, parameters); }));
}

LayerCosts measure_layers(Runtime& runtime, int windows) {
  LayerCosts costs;
  const ModelSpec spec;
  Conv2dShape shape{windows, spec.window_frames, spec.rows, spec.cols, 32, true};
  for (int layer = 0; layer < 3; ++layer) {
    measure_layer(runtime, shape, costs);
    shape = {windows,          shape.out_channels,     shape.out_rows(),
             shape.out_cols(), 2 * shape.out_channels, false};
  }
  return costs;
}

void verify_shares(Runtime& runtime, int windows, const std::function<void(Figure)>& emit) {
  const auto costs = measure_layers(runtime, windows);
  const double peak = peak_flops(runtime);
  const auto share = [&](const char* pass, const Cost& cost, double goal) {
    emit(at_least(fmt::format("convolution {}, {} windows, share of peak", pass, windows),
                  cost.flops / cost.seconds / peak, "", goal));
  };
  share("forward", costs.forward, 0.80);
  share("backward-data", costs.data, 0.75);
  share("backward-weights", costs.weights, 0.70);
}

}  // namespace

void verify_encoder(const std::function<void(Figure)>& emit) {
  Runtime runtime(choose_device(""));
  emit(reported("multiply-add peak", 1e-9 * peak_flops(runtime), "GFLOP/s"));
  emit(at_most("encoder step, 160 windows", step_ms(runtime, 160), "ms", 30.0));
  emit(reported("encoder step, 640 windows", step_ms(runtime, 640), "ms"));
  for (const int windows : {160, 640}) verify_shares(runtime, windows, emit);
}

}  // namespace touchtrace
