// Operations `conv2d` and `winograd`. The input in blocks is the pre-activation of the layer below,
// so that the gradient covers the ReLU mask that the kernels apply; planes are used as they are.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "engine/check/conv2d_reference.h"
#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"

namespace touchtrace {
namespace {

std::size_t in_plain_size(const Conv2dShape& s) {
  return std::size_t(s.images) * s.in_channels * s.rows * s.cols;
}

HaloLayout in_layout(const Conv2dShape& s) {
  return {s.rows, s.cols, s.in_planes ? 1 : 16, s.halo()};
}

HaloLayout out_layout(const Conv2dShape& s) {
  return {s.out_rows(), s.out_cols(), 16, s.out_halo()};
}

HaloLayout grad_out_layout(const Conv2dShape& s) {
  return {s.out_rows(), s.out_cols(), 16, s.halo()};
}

std::vector<double> activation(const Conv2dShape& s, std::vector<double> below) {
  if (!s.in_planes)
    for (auto& value : below) value = std::max(value, 0.0);
  return below;
}

Arrays reference(const Conv2dShape& s, const Arrays& inputs) {
  return {conv2d_reference(s, activation(s, inputs[0]), inputs[1], inputs[2])};
}

/// `gradient` where `output` is positive, else 0.
std::vector<double> masked(std::vector<double> gradient, const std::vector<double>& output) {
  for (std::size_t i = 0; i < gradient.size(); ++i)
    if (!(output[i] > 0)) gradient[i] = 0;
  return gradient;
}

Arrays reference_backward(const Conv2dShape& s, const Arrays& inputs, const Arrays& grads) {
  const auto in = activation(s, inputs[0]);
  const auto grad_sum = masked(grads[0], conv2d_reference(s, in, inputs[1], inputs[2]));
  auto grad = conv2d_backward_reference(s, in, inputs[1], grad_sum);
  if (s.in_planes) return {{}, grad.weight, grad.bias};
  return {masked(grad.in, in), grad.weight, grad.bias};
}

double kink_distance(const Conv2dShape& s, const Arrays& inputs) {
  auto near = conv2d_sum_reference(s, activation(s, inputs[0]), inputs[1], inputs[2]);
  if (!s.in_planes) near.insert(near.end(), inputs[0].begin(), inputs[0].end());
  double distance = std::abs(near[0]);
  for (double value : near) distance = std::min(distance, std::abs(value));
  return distance;
}

/// Layer on the device after its forward pass.
struct Layer {
  Layer(Runtime& runtime, const Conv2dShape& shape, Conv2dMethod method, const Arrays& inputs);

  Conv2dShape s;
  Conv2dParameters parameters;
  Conv2dMicroBatch batch;
  std::unique_ptr<Conv2d> conv;
};

Layer::Layer(Runtime& runtime, const Conv2dShape& shape, Conv2dMethod method, const Arrays& inputs)
    : s(shape) {
  const auto values = joined(inputs[1], inputs[2]);
  parameters = {upload(runtime, values), runtime.allocate_zeros<float>(values.size()), 0,
                static_cast<int>(inputs[1].size())};
  batch = {s.images, upload(runtime, with_halo(activation(s, inputs[0]), in_layout(s))),
           runtime.allocate_zeros<float>(s.out_size()),
           runtime.allocate_zeros<float>(s.grad_out_size()),
           s.in_planes ? Buffer<float>() : runtime.allocate_zeros<float>(s.in_size())};
  conv = make_conv2d(runtime, s, parameters, method);
  enqueue(runtime, conv->prepare());
  enqueue(runtime, conv->forward(batch));
}

std::vector<double> output(Runtime& runtime, const Layer& layer) {
  const auto& s = layer.s;
  return without_halo(download(runtime, layer.batch.out), out_layout(s));
}

Arrays forward(Runtime& runtime, const Conv2dShape& s, Conv2dMethod method, const Arrays& inputs) {
  return {output(runtime, Layer(runtime, s, method, inputs))};
}

Arrays backward(Runtime& runtime, const Conv2dShape& s, Conv2dMethod method, const Arrays& inputs,
                const Arrays& grads) {
  Layer layer(runtime, s, method, inputs);
  const auto grad_sum = masked(grads[0], output(runtime, layer));
  layer.batch.grad_out = upload(runtime, with_halo(grad_sum, grad_out_layout(s)));
  enqueue(runtime, layer.conv->backward(layer.batch, true));
  enqueue(runtime, layer.conv->finish());
  const auto [weight, bias] = split(download(runtime, layer.parameters.gradient), inputs[1].size());
  if (s.in_planes) return {{}, weight, bias};
  return {without_halo(download(runtime, layer.batch.grad_in), in_layout(s)), weight, bias};
}

}  // namespace

OperationCase conv2d_case(const Conv2dShape& s, Conv2dMethod method) {
  OperationCase c;
  c.shape = fmt::format("{} images {}x{}x{} in {} to {} channels by {}x{} of stride {}", s.images,
                        s.in_channels, s.rows, s.cols, s.in_planes ? "planes" : "blocks",
                        s.out_channels, s.kernel, s.kernel, s.stride);
  if (s.compact_output) c.shape += ", compact output";
  c.input_sizes = {in_plain_size(s), s.weight_size(), std::size_t(s.out_channels)};
  c.terms = double(s.taps()) * s.in_channels;
  c.reference = [s](const Arrays& in) { return reference(s, in); };
  c.forward = [s, method](Runtime& runtime, const Arrays& in) {
    return forward(runtime, s, method, in);
  };
  c.reference_backward = [s](const Arrays& in, const Arrays& g) {
    return reference_backward(s, in, g);
  };
  c.backward = [s, method](Runtime& runtime, const Arrays& in, const Arrays& g) {
    return backward(runtime, s, method, in, g);
  };
  c.kink_distance = [s](const Arrays& in) { return kink_distance(s, in); };
  return c;
}

/// Planes whose lower left quarter is zero.
static OperationCase case_with_dead_pixels(Conv2dShape s) {
  std::vector<std::uint8_t> live(std::size_t(s.rows) * s.cols);
  for (int pixel = 0; pixel < s.rows * s.cols; ++pixel)
    live[pixel] = pixel / s.cols < s.rows / 2 || pixel % s.cols >= s.cols / 2;
  s.dead = dead_pixels(s, live);
  auto c = conv2d_case(s, Conv2dMethod::direct);
  c.shape += fmt::format(", {} of their pixels dead", s.dead.size());
  c.prepare = [live](Arrays& inputs) {
    for (std::size_t i = 0; i < inputs[0].size(); ++i) inputs[0][i] *= live[i % live.size()];
  };
  return c;
}

/// Last layer of an encoder.
static Conv2dShape compact(Conv2dShape s) {
  s.compact_output = true;
  return s;
}

Operation conv2d_operation() {
  // images, in_channels, rows, cols, out_channels, in_planes, kernel, stride
  const Conv2dShape with_dead[] = {
      {2, 3, 9, 10, 32, true}, {2, 2, 7, 5, 32, true, 5, 1}, {3, 10, 32, 32, 32, true}};
  const Conv2dShape shapes[] = {{1, 32, 3, 4, 32, false},
                                {2, 3, 5, 6, 32, true},
                                {1, 32, 3, 4, 32, false, 5, 2},
                                {1, 32, 2, 3, 64, false, 5, 1},
                                {1, 64, 2, 3, 32, false, 3, 1},
                                {1, 1, 6, 6, 32, true},
                                {3, 10, 32, 32, 32, true},
                                {2, 32, 16, 16, 64, false},
                                {1, 32, 7, 13, 64, false},
                                {5, 64, 8, 8, 128, false},
                                {9, 32, 2, 1, 64, false},
                                {1, 32, 64, 9, 32, true},
                                {2, 10, 6, 6, 32, true, 3, 1},
                                {3, 3, 7, 13, 32, true, 5, 1},
                                {2, 10, 17, 8, 32, true, 5, 2},
                                {5, 64, 5, 7, 128, false, 3, 1},
                                {2, 32, 16, 9, 64, false, 5, 2},
                                {3, 64, 4, 6, 96, false, 5, 1},
                                {7, 32, 1, 2, 64, false, 5, 2},
                                compact({3, 64, 8, 8, 128, false}),
                                compact({2, 32, 5, 6, 64, false, 5, 1})};
  Operation operation{.name = "conv2d",
                      .cases = {conv2d_case(shapes[0], Conv2dMethod::direct)},
                      .small_cases = 7,
                      .has_gpu_variant = true};
  for (const auto& shape : with_dead) operation.cases.push_back(case_with_dead_pixels(shape));
  for (const auto& shape : std::span(shapes).subspan(1))
    operation.cases.push_back(conv2d_case(shape, Conv2dMethod::direct));
  return operation;
}

Operation winograd_operation() {
  Operation operation{.name = "winograd", .cases = {}};
  const Conv2dShape shapes[] = {{1, 32, 3, 4, 64, false},    {2, 32, 16, 16, 64, false},
                                {1, 32, 7, 13, 64, false},   {5, 64, 8, 8, 128, false},
                                {9, 32, 2, 1, 64, false},    {1, 96, 17, 9, 64, false},
                                {3, 32, 12, 24, 192, false}, compact({5, 64, 8, 8, 128, false})};
  for (const auto& shape : shapes)
    operation.cases.push_back(conv2d_case(shape, Conv2dMethod::winograd));
  return operation;
}

}  // namespace touchtrace
