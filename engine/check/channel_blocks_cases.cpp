// Operations of channel_blocks.h. `channel_blocks`: a ReLU whose output is moved into blocks;
// `block_order`: weights of a dense layer, converted to block order and back.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/check/host_arrays.h"
#include "engine/check/rows.h"
#include "engine/ops/channel_blocks.h"

namespace touchtrace {
namespace {

std::vector<double> rectified(std::vector<double> values) {
  for (auto& value : values) value = std::max(value, 0.0);
  return values;
}

std::vector<double> to_order(const ChannelBlocksShape& s, const std::vector<double>& values) {
  return in_block_order(values, s.channels, s.rows * s.cols);
}

std::vector<double> from_order(const ChannelBlocksShape& s, const std::vector<double>& values) {
  return in_plain_order(values, s.channels, s.rows * s.cols);
}

Buffer<float> rectified_rows(Runtime& runtime, const ChannelBlocksShape& s, const Arrays& inputs) {
  const auto rows = runtime.allocate<float>(s.row_size());
  to_blocks(runtime, s, {upload(runtime, rectified(inputs[0]))}, rows).enqueue(runtime);
  return rows;
}

Arrays rectified_backward(const ChannelBlocksShape& s, const Arrays& inputs, const Arrays& grads) {
  auto grad = from_order(s, grads[0]);
  for (std::size_t i = 0; i < grad.size(); ++i)
    if (!(inputs[0][i] > 0)) grad[i] = 0;
  return {grad};
}

Arrays gradient_of(Runtime& runtime, const ChannelBlocksShape& s, const Arrays& inputs,
                   const Arrays& grads) {
  const auto images = runtime.allocate_zeros<float>(s.image_size());
  block_gradient(runtime, s, rectified_rows(runtime, s, inputs), upload(runtime, grads[0]), images)
      .enqueue(runtime);
  return {without_halo(download(runtime, images), {s.rows, s.cols, 16, s.halo})};
}

OperationCase case_of(const ChannelBlocksShape& s) {
  OperationCase c;
  c.shape = fmt::format("{} images {}x{}x{}", s.images, s.channels, s.rows, s.cols);
  c.input_sizes = {s.row_size()};
  c.terms = 1;
  return c;
}

OperationCase gradient_case(const ChannelBlocksShape& s) {
  auto c = case_of(s);
  c.reference = [s](const Arrays& in) { return Arrays{to_order(s, rectified(in[0]))}; };
  c.forward = [s](Runtime& runtime, const Arrays& in) {
    return Arrays{download(runtime, rectified_rows(runtime, s, in))};
  };
  c.reference_backward = [s](const Arrays& in, const Arrays& g) {
    return rectified_backward(s, in, g);
  };
  c.backward = [s](Runtime& runtime, const Arrays& in, const Arrays& g) {
    return gradient_of(runtime, s, in, g);
  };
  c.kink_distance = [](const Arrays& in) {
    double distance = 1.0;
    for (double value : in[0]) distance = std::min(distance, std::abs(value));
    return distance;
  };
  return c;
}

OperationCase block_order_case(const ChannelBlocksShape& s) {
  auto c = case_of(s);
  c.reference = [s](const Arrays& in) { return Arrays{to_order(s, in[0])}; };
  c.forward = [s](Runtime& runtime, const Arrays& in) {
    const auto blocks = runtime.allocate<float>(s.row_size());
    to_blocks(runtime, s, {upload(runtime, in[0])}, blocks).enqueue(runtime);
    return Arrays{download(runtime, blocks)};
  };
  c.reference_backward = [s](const Arrays&, const Arrays& g) {
    return Arrays{from_order(s, g[0])};
  };
  c.backward = [s](Runtime& runtime, const Arrays&, const Arrays& g) {
    const auto plain = runtime.allocate<float>(s.row_size());
    from_blocks(runtime, s, upload(runtime, g[0]), {plain}).enqueue(runtime);
    return Arrays{download(runtime, plain)};
  };
  return c;
}

}  // namespace

Operation channel_blocks_operation() {
  Operation operation{
      .name = "channel_blocks", .cases = {}, .small_cases = 1, .has_gpu_variant = true};
  for (const ChannelBlocksShape& shape :
       {ChannelBlocksShape{2, 16, 2, 3}, {3, 128, 4, 4}, {1, 32, 1, 8, 2}}) {
    operation.cases.push_back(gradient_case(shape));
    operation.cases.push_back(block_order_case(shape));
  }
  return operation;
}

}  // namespace touchtrace
