#include "tests/verify/engine/encoder_reference.h"

#include <algorithm>
#include <utility>

#include "engine/check/conv2d_reference.h"
#include "engine/check/layer_norm_reference.h"

namespace touchtrace {

std::vector<double> FlatParameters::operator[](const std::string& name) const {
  const auto& row = table.at(name);
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row.offset);
  return {begin, begin + static_cast<std::ptrdiff_t>(row.size)};
}

void FlatParameters::set(const std::string& name, const std::vector<double>& grad) {
  std::ranges::copy(grad, gradient.begin() + static_cast<std::ptrdiff_t>(table.at(name).offset));
}

ConvStackTrace conv_stack_reference(const std::string& name, const ConvStackShape& shape,
                                    const FlatParameters& p, std::vector<double> windows) {
  ConvStackTrace trace{name, shape.layers(), {}, {}};
  trace.layers[0] = std::move(windows);
  for (int i = 0; i < 3; ++i) {
    const auto layer = trace.conv(i + 1);
    trace.sums[i] = conv2d_sum_reference(trace.shapes[i], trace.layers[i], p[layer + ".weight"],
                                         p[layer + ".bias"]);
    for (double sum : trace.sums[i]) trace.layers[i + 1].push_back(std::max(sum, 0.0));
  }
  return trace;
}

void conv_stack_backward_reference(const ConvStackTrace& trace, std::vector<double> grad,
                                   FlatParameters& p) {
  for (int i = 3; i >= 1; --i) {
    for (std::size_t j = 0; j < grad.size(); ++j)
      if (!(trace.layers[i][j] > 0)) grad[j] = 0.0;
    auto below = conv2d_backward_reference(trace.shapes[i - 1], trace.layers[i - 1],
                                           p[trace.conv(i) + ".weight"], grad);
    p.set(trace.conv(i) + ".weight", below.weight), p.set(trace.conv(i) + ".bias", below.bias);
    grad = std::move(below.in);
  }
}

EncoderTrace encode_reference(const std::string& name, const ConvStackShape& shape, int embedding,
                              const FlatParameters& p, std::vector<double> windows) {
  EncoderTrace trace{conv_stack_reference(name, shape, p, std::move(windows)), {}, {}};
  trace.dense.resize(std::size_t(shape.windows.windows) * embedding);
  trace.dense = dense_reference(trace.dense_shape(), trace.layers[3], p[name + ".dense.weight"],
                                p[name + ".dense.bias"]);
  trace.embedding =
      layer_norm_reference(trace.dense, p[name + ".norm.weight"], p[name + ".norm.bias"]);
  return trace;
}

void encode_backward_reference(const EncoderTrace& trace, const std::vector<double>& grad_embedding,
                               FlatParameters& p) {
  const auto& name = trace.name;
  const auto norm =
      layer_norm_backward_reference(trace.dense, p[name + ".norm.weight"], grad_embedding);
  p.set(name + ".norm.weight", norm.gain), p.set(name + ".norm.bias", norm.bias);
  const auto dense = dense_backward_reference(trace.dense_shape(), trace.layers[3],
                                              p[name + ".dense.weight"], norm.x);
  p.set(name + ".dense.weight", dense.weight), p.set(name + ".dense.bias", dense.bias);
  conv_stack_backward_reference(trace, dense.in, p);
}

}  // namespace touchtrace
