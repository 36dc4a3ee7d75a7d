// The row of channel_blocks in the table of operations: the identity forwards, a ReLU backwards.
// Its input is the plain image, moved into blocks by the host.
#include <fmt/core.h>

#include <algorithm>

#include "engine/ops/channel_blocks.h"
#include "engine/ops/host_arrays.h"
#include "engine/ops/rows.h"

namespace touchtrace {
namespace {

Arrays rectified(const Arrays& inputs) {
  auto out = inputs[0];
  for (auto& value : out) value = std::max(value, 0.0);
  return {out};
}

Arrays rectified_backward(const Arrays& inputs, const Arrays& grads) {
  auto grad = grads[0];
  for (std::size_t i = 0; i < grad.size(); ++i)
    if (!(inputs[0][i] > 0)) grad[i] = 0;
  return {grad};
}

/// The plain image after its ReLU, moved from blocks on the device.
Buffer<float> unblocked(Runtime& runtime, const ChannelBlocksShape& s, const Arrays& inputs) {
  const auto plain = runtime.allocate<float>(s.plain_size());
  const auto blocked = upload(runtime, with_halo(rectified(inputs)[0], s.rows, s.cols, 16));
  unblock(runtime, s, blocked, plain).enqueue(runtime);
  return plain;
}

Arrays backward(Runtime& runtime, const ChannelBlocksShape& s, const Arrays& inputs,
                const Arrays& grads) {
  const auto blocked = runtime.allocate_zeros<float>(s.blocked_size());
  BlockGradient(runtime, s, unblocked(runtime, s, inputs), blocked)
      .enqueue(runtime, upload(runtime, grads[0]));
  return {without_halo(download(runtime, blocked), s.rows, s.cols, 16)};
}

OperationCase channel_blocks_case(const ChannelBlocksShape& s) {
  OperationCase c;
  c.shape = fmt::format("{} images {}x{}x{}", s.images, s.channels, s.rows, s.cols);
  c.input_sizes = {s.plain_size()};
  c.terms = 1;
  c.reference = rectified;
  c.forward = [s](Runtime& runtime, const Arrays& in) {
    return Arrays{download(runtime, unblocked(runtime, s, in))};
  };
  c.reference_backward = rectified_backward;
  c.backward = [s](Runtime& runtime, const Arrays& in, const Arrays& g) {
    return backward(runtime, s, in, g);
  };
  c.kink_distance = [](const Arrays& in) {
    double distance = 1.0;
    for (double value : in[0]) distance = std::min(distance, std::abs(value));
    return distance;
  };
  return c;
}

}  // namespace

Operation channel_blocks_operation() {
  Operation operation{"channel_blocks", {}};
  for (const ChannelBlocksShape& shape :
       {ChannelBlocksShape{2, 16, 2, 3}, {3, 128, 4, 4}, {1, 32, 1, 8}})
    operation.cases.push_back(channel_blocks_case(shape));
  return operation;
}

}  // namespace touchtrace
