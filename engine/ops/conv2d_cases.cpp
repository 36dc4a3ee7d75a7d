// The row of conv2d in the table of operations. Its input is what stands before the ReLU of the
// layer below, so that the mask which the kernels apply is part of the gradient; planes are taken
// as given.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/ops/channel_blocks.h"
#include "engine/ops/conv2d_reference.h"
#include "engine/ops/host_arrays.h"
#include "engine/ops/rows.h"

namespace touchtrace {
namespace {

std::size_t in_plain_size(const Conv2dShape& s) {
  return std::size_t(s.images) * s.in_channels * s.rows * s.cols;
}

std::vector<double> activation(const Conv2dShape& s, std::vector<double> below) {
  if (!s.in_planes)
    for (auto& value : below) value = std::max(value, 0.0);
  return below;
}

Arrays reference(const Conv2dShape& s, const Arrays& inputs) {
  return {conv2d_reference(s, activation(s, inputs[0]), inputs[1], inputs[2])};
}

/// `gradient` where `output` is above zero.
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

/// A layer on the device with its forward pass done.
struct Layer {
  Layer(Runtime& runtime, const Conv2dShape& shape, const Arrays& inputs);

  Conv2dShape s;
  Conv2dPlaces places;
  Buffer<float> parameters, in, out, plain_out;
};

Layer::Layer(Runtime& runtime, const Conv2dShape& shape, const Arrays& inputs)
    : s(shape),
      places{0, static_cast<int>(inputs[1].size())},
      parameters(upload(runtime, joined(inputs[1], inputs[2]))),
      in(upload(runtime,
                with_halo(activation(s, inputs[0]), s.rows, s.cols, s.in_planes ? 1 : 16))),
      out(runtime.allocate_zeros<float>(s.out_size())),
      plain_out(runtime.allocate<float>(s.images * s.out_channels * s.out_rows() * s.out_cols())) {
  Conv2dForward(runtime, s, places, in, out).enqueue(runtime, parameters);
  unblock(runtime, {s.images, s.out_channels, s.out_rows(), s.out_cols()}, out, plain_out)
      .enqueue(runtime);
}

Arrays forward(Runtime& runtime, const Conv2dShape& s, const Arrays& inputs) {
  return {download(runtime, Layer(runtime, s, inputs).plain_out)};
}

std::vector<double> grad_in(Runtime& runtime, const Layer& layer, const Buffer<float>& grad_out) {
  const auto& s = layer.s;
  const auto grad = runtime.allocate_zeros<float>(s.in_size());
  Conv2dBackwardData(runtime, s, layer.places, layer.in, grad_out, grad)
      .enqueue(runtime, layer.parameters);
  return without_halo(download(runtime, grad), s.rows, s.cols, 16);
}

Arrays backward(Runtime& runtime, const Conv2dShape& s, const Arrays& inputs, const Arrays& grads) {
  const Layer layer(runtime, s, inputs);
  const auto grad_out = runtime.allocate_zeros<float>(s.out_size());
  BlockGradient(runtime, {s.images, s.out_channels, s.out_rows(), s.out_cols()}, layer.plain_out,
                grad_out)
      .enqueue(runtime, upload(runtime, grads[0]));
  const auto gradient = runtime.allocate_zeros<float>(layer.parameters.size());
  Conv2dBackwardWeights(runtime, s, layer.places, layer.in, grad_out).enqueue(runtime, gradient);
  const auto [weight, bias] = split(download(runtime, gradient), inputs[1].size());
  if (s.in_planes) return {{}, weight, bias};
  return {grad_in(runtime, layer, grad_out), weight, bias};
}

OperationCase conv2d_case(const Conv2dShape& s) {
  OperationCase c;
  c.shape = fmt::format("{} images {}x{}x{} in {} to {} channels", s.images, s.in_channels, s.rows,
                        s.cols, s.in_planes ? "planes" : "blocks", s.out_channels);
  c.input_sizes = {in_plain_size(s), std::size_t(s.out_channels) * s.in_channels * 9,
                   std::size_t(s.out_channels)};
  c.terms = 9.0 * s.in_channels;
  c.reference = [s](const Arrays& in) { return reference(s, in); };
  c.forward = [s](Runtime& runtime, const Arrays& in) { return forward(runtime, s, in); };
  c.reference_backward = [s](const Arrays& in, const Arrays& g) {
    return reference_backward(s, in, g);
  };
  c.backward = [s](Runtime& runtime, const Arrays& in, const Arrays& g) {
    return backward(runtime, s, in, g);
  };
  c.kink_distance = [s](const Arrays& in) { return kink_distance(s, in); };
  return c;
}

}  // namespace

Operation conv2d_operation() {
  Operation operation{"conv2d", {}};
  const Conv2dShape shapes[] = {
      {2, 3, 5, 6, 32, true},    {1, 32, 3, 4, 32, false},   {1, 1, 6, 6, 32, true},
      {3, 10, 32, 32, 32, true}, {2, 32, 16, 16, 64, false}, {1, 32, 7, 13, 64, false},
      {5, 64, 8, 8, 128, false}, {9, 32, 2, 1, 64, false},   {1, 32, 64, 9, 32, true}};
  for (const auto& shape : shapes) operation.cases.push_back(conv2d_case(shape));
  return operation;
}

}  // namespace touchtrace
