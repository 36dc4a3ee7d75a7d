#include <fmt/core.h>

#include <numeric>
#include <utility>

#include "engine/base/random.h"
#include "engine/cl/timing.h"
#include "engine/model/tactile_encoder.h"
#include "engine/ops/conv2d.h"
#include "engine/ops/dense.h"
#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {
namespace {

Buffer<float> normal_buffer(Runtime& runtime, std::size_t size) {
  RandomStream random(1, "verify encoder");
  std::vector<float> values(size);
  for (auto& value : values) value = static_cast<float>(random.normal());
  return runtime.upload<float>(values);
}

/// Milliseconds of a forward and a backward pass of the default model's convolutions.
double step_ms(Runtime& runtime, int windows) {
  const ModelSpec spec;
  ParameterTable table;
  const auto shape = window_encoder(spec, windows);
  ConvStack::declare("tactile", shape, table);
  const Weights weights{table, runtime.upload<float>(table.initial_values(1)),
                        runtime.allocate_zeros<float>(table.size())};
  ConvStack encoder(runtime, "tactile", shape, weights);
  std::vector<int> last(static_cast<std::size_t>(windows));
  std::iota(last.begin(), last.end(), spec.window_frames - 1);
  const auto window_end = runtime.upload<int>(last);
  const auto frames = static_cast<std::size_t>(windows + spec.window_frames);
  const auto stream = normal_buffer(runtime, frames * spec.rows * spec.cols);
  return 1e3 * median_seconds(runtime, [&] {
           encoder.prepare();
           encoder.forward(stream, window_end, {0.2, 1});
           encoder.backward();
         });
}

/// Floating-point operations of a pass, summed over layers, and those at the device's peak in the
/// same time.
struct Cost {
  double flops = 0.0, at_peak = 0.0;

  double fraction() const { return flops / at_peak; }
};

struct LayerCosts {
  Cost forward, data, weights;
};

void measure(Runtime& runtime, const Launches& launches, double flops, Cost& cost) {
  cost.flops += flops;
  cost.at_peak += peak_equivalent_flops(runtime, [&] { enqueue(runtime, launches); });
}

/// `windows` images in micro-batches of `shape.images`, each with its own arrays, as in ConvStack.
std::vector<Conv2dMicroBatch> make_micro_batches(Runtime& runtime, const Conv2dShape& shape,
                                                 int windows) {
  std::vector<Conv2dMicroBatch> batches;
  for (int first = 0; first < windows; first += shape.images)
    batches.push_back(
        {shape.images, normal_buffer(runtime, shape.in_size()),
         normal_buffer(runtime, shape.out_size()), normal_buffer(runtime, shape.out_size()),
         shape.in_planes ? Buffer<float>() : runtime.allocate_zeros<float>(shape.in_size())});
  return batches;
}

/// Measures a layer over all windows, including the preparation of its weights.
void measure_layer(Runtime& runtime, const Conv2dShape& shape, int windows, Conv2dMethod method,
                   LayerCosts& costs) {
  const auto values = normal_buffer(runtime, shape.weight_size() + shape.out_channels);
  const auto conv = make_conv2d(
      runtime, shape, {values, values, 0, static_cast<int>(shape.weight_size())}, {method});
  const auto batches = make_micro_batches(runtime, shape, windows);
  Launches forward = conv->prepare(), weights, data;
  for (const auto& batch : batches) {
    const auto backward = conv->backward(batch, &batch == &batches.front());
    forward.push_back(conv->forward(batch).front());
    weights.push_back(backward.front());
    if (!shape.in_planes) data.push_back(backward.back());
  }
  weights.push_back(conv->finish().front());
  const double flops = shape.flops() * static_cast<double>(batches.size());
  measure(runtime, forward, flops, costs.forward);
  measure(runtime, weights, flops, costs.weights);
  if (!shape.in_planes) measure(runtime, data, flops, costs.data);
}

LayerCosts measure_layers(Runtime& runtime, int windows, int batch_windows,
                          const std::function<Conv2dMethod(const Conv2dShape&)>& method) {
  LayerCosts costs;
  for (const auto& layer : window_encoder(ModelSpec{}, batch_windows).layers())
    measure_layer(runtime, layer, windows, method(layer), costs);
  return costs;
}

/// Measures the dense layers of the default model over `rows` windows: forward and both gradients.
Cost measure_dense(Runtime& runtime, int rows) {
  const ModelSpec spec;
  const int features = 128 * (spec.rows / 8) * (spec.cols / 8);
  Cost cost;
  for (const auto& [inputs, outputs] :
       {std::pair{features, spec.embedding}, {spec.embedding, spec.hidden}}) {
    const auto matrix = [&](int n, int columns) {
      return MatrixView{normal_buffer(runtime, std::size_t(n) * columns), 0, columns};
    };
    const auto in = matrix(rows, inputs), out = matrix(rows, outputs),
               weight = matrix(outputs, inputs), by_input = matrix(inputs, outputs);
    const double flops = 2.0 * rows * inputs * outputs;
    measure(runtime, gemm(runtime, in, by_input, {}, out, rows, outputs, inputs), flops, cost);
    measure(runtime, gemm(runtime, out, weight, {}, in, rows, inputs, outputs), flops, cost);
    measure(runtime, gemm(runtime, out.transposed(), in, {}, weight, outputs, inputs, rows), flops,
            cost);
  }
  return cost;
}

void emit_fractions(const std::string& what, const LayerCosts& costs,
                    const std::function<void(Figure)>& emit) {
  const auto add = [&](const char* pass, const Cost& cost, double goal) {
    emit(at_least(fmt::format("convolution {}, {}, of peak", pass, what), cost.fraction(), "",
                  goal));
  };
  add("forward", costs.forward, 0.80);
  add("backward-data", costs.data, 0.75);
  add("backward-weights", costs.weights, 0.70);
}

/// Fractions of the peak that the direct method and the default methods reach. Operations are those
/// of the direct method; Winograd needs fewer.
void verify_fractions(Runtime& runtime, int windows, const std::function<void(Figure)>& emit) {
  const int batch = ConvStack::micro_batch_windows;
  const auto direct = [](const Conv2dShape&) { return Conv2dMethod::direct; };
  emit_fractions(fmt::format("direct, {} windows", windows),
                 measure_layers(runtime, windows, batch, direct), emit);
  emit_fractions(fmt::format("as used, {} windows", windows),
                 measure_layers(runtime, windows, batch, best_method), emit);
  const auto dense = measure_dense(runtime, windows);
  emit(at_least(fmt::format("dense layers, {} windows, of peak", windows), dense.fraction(), "",
                0.70));
}

}  // namespace

void verify_encoder(const std::function<void(Figure)>& emit) {
  Runtime runtime(choose_device(""));
  emit(reported("multiply-add peak", 1e-9 * peak_flops(runtime), "GFLOP/s"));
  emit(at_most("encoder step, 160 windows", step_ms(runtime, 160), "ms", 30.0));
  emit(reported("encoder step, 640 windows", step_ms(runtime, 640), "ms"));
  for (const int windows : {160, 640}) verify_fractions(runtime, windows, emit);
}

}  // namespace touchtrace
