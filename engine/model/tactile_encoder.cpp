#include "engine/model/tactile_encoder.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "engine/ops/channel_blocks.h"
#include "engine/ops/conv2d.h"

namespace touchtrace {
namespace {

constexpr std::array channels{32, 64, 128};
using Shapes = std::array<Conv2dShape, 3>;

void check(const TactileWindowShape& window) {
  const auto fits = [](int size) { return size >= 6 && size <= 64; };
  if (!fits(window.rows) || !fits(window.cols) || window.frames < 1 || window.frames > 32)
    throw usage_error(fmt::format("an encoder of touch cannot take windows of {} frames of {} x {}",
                                  window.frames, window.rows, window.cols),
                      "frames have 6 to 64 rows and columns, windows 1 to 32 frames");
}

Shapes shapes_of(const TactileWindowShape& window) {
  check(window);
  Shapes shapes{};
  shapes[0] = {window.windows, window.frames, window.rows, window.cols, channels[0], true};
  for (int i = 1; i < 3; ++i) {
    const auto& below = shapes[i - 1];
    shapes[i] = {window.windows,   below.out_channels, below.out_rows(),
                 below.out_cols(), channels[i],        false};
  }
  return shapes;
}

ChannelBlocksShape features_shape(const Conv2dShape& last) {
  return {last.images, last.out_channels, last.out_rows(), last.out_cols()};
}

/// Weight and bias of a layer, started as PyTorch's Conv2d.
Conv2dPlaces add_layer(ParameterTable& table, const Conv2dShape& shape, const std::string& name) {
  const Initial initial{0.0, 1.0 / std::sqrt(9.0 * shape.in_channels)};
  const auto weight =
      table.add(name + ".weight", {shape.out_channels, shape.in_channels, 3, 3}, initial);
  const auto bias = table.add(name + ".bias", {shape.out_channels}, initial);
  return {static_cast<int>(weight.offset), static_cast<int>(bias.offset)};
}

std::array<Conv2dPlaces, 3> add_layers(ParameterTable& table, const Shapes& shapes,
                                       const std::string& name) {
  return {add_layer(table, shapes[0], name + ".conv1"),
          add_layer(table, shapes[1], name + ".conv2"),
          add_layer(table, shapes[2], name + ".conv3")};
}

}  // namespace

struct TactileEncoder::Plan {
  /// What only the backward pass needs: the gradients of the layers' outputs, and its launches.
  struct Backward {
    Buffer<float> grad1, grad2, grad3;
    BlockGradient block;
    Conv2dBackwardData data3, data2;
    Conv2dBackwardWeights weights3, weights2, weights1;
  };

  Plan(Runtime& device, const std::string& name, const TactileWindowShape& windows, bool training,
       ParameterTable& table);

  Runtime& runtime;
  Shapes shapes;
  std::array<Conv2dPlaces, 3> places;
  Buffer<float> input, out1, out2, out3, features;  ///< out1 .. out3 in blocks
  TactileWindow window;
  Conv2dForward conv1, conv2, conv3;
  Launch unblock_features;
  Buffer<float> parameters;  ///< of the last forward pass
  std::optional<Backward> backward;
};

TactileEncoder::Plan::Plan(Runtime& device, const std::string& name,
                           const TactileWindowShape& windows, bool training, ParameterTable& table)
    : runtime(device),
      shapes(shapes_of(windows)),
      places(add_layers(table, shapes, name)),
      input(device.allocate_zeros<float>(shapes[0].in_size())),
      out1(device.allocate_zeros<float>(shapes[0].out_size())),
      out2(device.allocate_zeros<float>(shapes[1].out_size())),
      out3(device.allocate_zeros<float>(shapes[2].out_size())),
      features(device.allocate<float>(features_shape(shapes[2]).plain_size())),
      window(device, windows, input),
      conv1(device, shapes[0], places[0], input, out1),
      conv2(device, shapes[1], places[1], out1, out2),
      conv3(device, shapes[2], places[2], out2, out3),
      unblock_features(unblock(device, features_shape(shapes[2]), out3, features)) {
  if (!training) return;
  const auto grad1 = device.allocate_zeros<float>(out1.size());
  const auto grad2 = device.allocate_zeros<float>(out2.size());
  const auto grad3 = device.allocate_zeros<float>(out3.size());
  backward = Backward{grad1,
                      grad2,
                      grad3,
                      BlockGradient(device, features_shape(shapes[2]), features, grad3),
                      Conv2dBackwardData(device, shapes[2], places[2], out2, grad3, grad2),
                      Conv2dBackwardData(device, shapes[1], places[1], out1, grad2, grad1),
                      Conv2dBackwardWeights(device, shapes[2], places[2], out2, grad3),
                      Conv2dBackwardWeights(device, shapes[1], places[1], out1, grad2),
                      Conv2dBackwardWeights(device, shapes[0], places[0], input, grad1)};
}

TactileEncoder::TactileEncoder(Runtime& runtime, const std::string& name,
                               const TactileWindowShape& windows, bool training,
                               ParameterTable& table)
    : plan_(std::make_unique<Plan>(runtime, name, windows, training, table)) {}

TactileEncoder::~TactileEncoder() = default;

int TactileEncoder::windows() const { return plan_->shapes[0].images; }

int TactileEncoder::feature_size() const {
  const auto& last = plan_->shapes[2];
  return last.out_channels * last.out_rows() * last.out_cols();
}

const Buffer<float>& TactileEncoder::features() const { return plan_->features; }

void TactileEncoder::forward(const Buffer<float>& stream, const Buffer<int>& last_frame,
                             const Buffer<float>& parameters, const TaxelDropout& dropout) {
  auto& p = *plan_;
  p.window.enqueue(p.runtime, stream, last_frame, dropout);
  p.conv1.enqueue(p.runtime, parameters);
  p.conv2.enqueue(p.runtime, parameters);
  p.conv3.enqueue(p.runtime, parameters);
  p.unblock_features.enqueue(p.runtime);
  p.parameters = parameters;
}

void TactileEncoder::backward(const Buffer<float>& grad_features, const Buffer<float>& gradient) {
  auto& p = *plan_;
  auto& b = p.backward.value();
  b.block.enqueue(p.runtime, grad_features);
  b.weights3.enqueue(p.runtime, gradient);
  b.data3.enqueue(p.runtime, p.parameters);
  b.weights2.enqueue(p.runtime, gradient);
  b.data2.enqueue(p.runtime, p.parameters);
  b.weights1.enqueue(p.runtime, gradient);
}

}  // namespace touchtrace
