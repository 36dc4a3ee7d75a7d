#include "engine/model/tactile_encoder.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ranges>

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

/// Of the layers, over `images` windows.
Shapes shapes_of(const TactileWindowShape& window, int images) {
  check(window);
  Shapes shapes{};
  shapes[0] = {images, window.frames, window.rows, window.cols, channels[0], true};
  for (int i = 1; i < 3; ++i) {
    const auto& below = shapes[i - 1];
    shapes[i] = {images,           below.out_channels, below.out_rows(),
                 below.out_cols(), channels[i],        false};
  }
  return shapes;
}

ChannelBlocksShape outputs_of(const Conv2dShape& last, int images) {
  return {images, last.out_channels, last.out_rows(), last.out_cols()};
}

std::string layer_name(const std::string& encoder, int layer) {
  return fmt::format("{}.conv{}", encoder, layer + 1);
}

Conv2dParameters parameters_of(const Weights& weights, const std::string& layer) {
  return {weights.values, weights.gradient, weights.value(layer + ".weight").at,
          weights.value(layer + ".bias").at};
}

/// The input of the layers, and their outputs.
using Images = std::array<Buffer<float>, 4>;

std::size_t size_of_images(const Shapes& shapes) {
  return shapes[0].in_size() + shapes[0].out_size() + shapes[1].out_size() + shapes[2].out_size();
}

Images allocate_images(Runtime& runtime, const Shapes& shapes) {
  return {runtime.allocate_zeros<float>(shapes[0].in_size()),
          runtime.allocate_zeros<float>(shapes[0].out_size()),
          runtime.allocate_zeros<float>(shapes[1].out_size()),
          runtime.allocate_zeros<float>(shapes[2].out_size())};
}

/// In training the weights of Winograd's method are made anew at every update, which pays from some
/// thirty images on. In prediction few windows come at a time: their time goes into reading
/// weights, which should stay in a second-level cache; and the number of windows must not change a
/// bit.
Conv2dMethod method_for(const Conv2dShape& shape, bool training) {
  constexpr int worth_it = 32;
  constexpr std::size_t cached_floats = 1u << 18, weight_sets_a_tap = 4;
  const bool pays = training ? shape.images >= worth_it
                             : weight_sets_a_tap * shape.weight_size() <= cached_floats;
  return pays ? best_method(shape) : Conv2dMethod::direct;
}

void append(Launches& launches, const Launches& more) {
  launches.insert(launches.end(), more.begin(), more.end());
}

}  // namespace

struct TactileEncoder::Plan {
  struct Part {
    TactileWindow window;
    Launches forward, backward;
  };

  Plan(Runtime& device, const std::string& name, const TactileWindowShape& all,
       const Weights& weights);
  void add_layer(const Conv2dParameters& parameters, const Conv2dShape& shape);
  void add_part(int first, int size, const Images& images, const Images& gradients);

  Runtime& runtime;
  TactileWindowShape windows;
  bool training;
  Shapes shapes;  ///< of the largest part
  Buffer<float> features, grad_features;
  std::vector<std::unique_ptr<Conv2d>> layers;
  std::vector<Part> parts;
  Launches prepare, finish;
};

TactileEncoder::Plan::Plan(Runtime& device, const std::string& name, const TactileWindowShape& all,
                           const Weights& weights)
    : runtime(device),
      windows(all),
      training(weights.gradient.size() > 0),
      shapes(shapes_of(all, std::min(all.windows, part_windows))),
      features(device.allocate<float>(TactileEncoder::features_shape(all).row_size())) {
  for (int i = 0; i < 3; ++i) add_layer(parameters_of(weights, layer_name(name, i)), shapes[i]);
  const auto parts_of_their_own = training ? (all.windows + part_windows - 1) / part_windows : 1;
  device.check_memory(sizeof(float) * size_of_images(shapes) * std::size_t(parts_of_their_own));
  Images images, gradients;
  if (training) {
    grad_features = device.allocate<float>(features.size());
    gradients = allocate_images(device, shapes);
  }
  gradients[0] = {};  // nothing learnable stands before the first layer
  // Only the first part may be smaller: the backward pass starts with the last.
  int size = (all.windows - 1) % part_windows + 1;
  for (int first = 0; first < all.windows; first += size, size = part_windows) {
    if (training || first == 0) images = allocate_images(device, shapes);
    add_part(first, size, images, gradients);
  }
}

void TactileEncoder::Plan::add_layer(const Conv2dParameters& parameters, const Conv2dShape& shape) {
  layers.push_back(make_conv2d(runtime, shape, parameters, {method_for(shape, training)}));
  append(prepare, layers.back()->prepare());
  if (training) append(finish, layers.back()->finish());
}

void TactileEncoder::Plan::add_part(int first, int size, const Images& images,
                                    const Images& gradients) {
  auto window = windows;
  window.windows = size;
  const auto last = outputs_of(shapes[2], size);
  Part part{TactileWindow(runtime, window, images[0], first), {}, {}};
  const bool last_part = first + size == windows.windows;
  const auto of_layer = [&](int i) {
    return Conv2dImages{size, images[i], images[i + 1], gradients[i + 1], gradients[i]};
  };
  for (int i = 0; i < 3; ++i) append(part.forward, layers[i]->forward(of_layer(i)));
  part.forward.push_back(compact(runtime, last, images[3], features, first));
  if (training)
    part.backward = {block_gradient(runtime, last, features, grad_features, gradients[3], first)};
  for (int i = 2; training && i >= 0; --i)
    append(part.backward, layers[i]->backward(of_layer(i), last_part));
  parts.push_back(std::move(part));
}

void TactileEncoder::declare(const std::string& name, const TactileWindowShape& windows,
                             ParameterTable& table) {
  const auto shapes = shapes_of(windows, 1);
  for (int i = 0; i < 3; ++i) {
    const auto& shape = shapes[i];
    const Initial initial{0.0, 1.0 / std::sqrt(9.0 * shape.in_channels)};
    const auto layer = layer_name(name, i);
    table.add(layer + ".weight", {shape.out_channels, shape.in_channels, 3, 3}, initial);
    table.add(layer + ".bias", {shape.out_channels}, initial);
  }
}

ChannelBlocksShape TactileEncoder::features_shape(const TactileWindowShape& windows) {
  return outputs_of(shapes_of(windows, 1)[2], windows.windows);
}

TactileEncoder::TactileEncoder(Runtime& runtime, const std::string& name,
                               const TactileWindowShape& windows, const Weights& weights)
    : plan_(std::make_unique<Plan>(runtime, name, windows, weights)) {}

TactileEncoder::~TactileEncoder() = default;

const Buffer<float>& TactileEncoder::features() const { return plan_->features; }

void TactileEncoder::prepare() { enqueue(plan_->runtime, plan_->prepare); }

void TactileEncoder::forward(const Buffer<float>& stream, const Buffer<int>& last_frame,
                             const TaxelDropout& dropout) {
  for (auto& part : plan_->parts) {
    part.window.enqueue(plan_->runtime, stream, last_frame, dropout);
    enqueue(plan_->runtime, part.forward);
  }
}

const Buffer<float>& TactileEncoder::grad_features() const { return plan_->grad_features; }

void TactileEncoder::backward() {
  // The last part's images are those that the cache may still hold.
  for (const auto& part : plan_->parts | std::views::reverse)
    enqueue(plan_->runtime, part.backward);
  enqueue(plan_->runtime, plan_->finish);
}

}  // namespace touchtrace
