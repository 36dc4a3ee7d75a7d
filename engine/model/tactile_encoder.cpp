#include "engine/model/tactile_encoder.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "engine/base/error.h"
#include "engine/base/integer_math.h"

namespace touchtrace {
namespace {

constexpr std::array channels{32, 64, 128};
constexpr int queues = 2;  // that parts are shared out to
using Shapes = std::array<Conv2dShape, 3>;
constexpr int usual_part = TactileEncoder::part_windows;

void check(const TactileWindowShape& window) {
  const auto fits = [](int size) { return size >= 6 && size <= 64; };
  if (!fits(window.rows) || !fits(window.cols) || window.frames < 1 || window.frames > 32)
    throw usage_error(fmt::format("an encoder of touch cannot take windows of {} frames of {} x {}",
                                  window.frames, window.rows, window.cols),
                      "frames have 6 to 64 rows and columns, windows 1 to 32 frames");
}

/// An order of pixels other than that of memory costs a little too.
std::vector<int> worthwhile_dead_pixels(const Conv2dShape& layer, const LiveTaxels& live) {
  constexpr int pays_from = 8;  // one pixel of so many
  if (live.empty()) return {};
  auto dead = dead_pixels(layer, live);
  if (pays_from * static_cast<int>(dead.size()) < layer.out_rows() * layer.out_cols()) dead.clear();
  return dead;
}

std::string layer_name(const std::string& encoder, int layer) {
  return fmt::format("{}.conv{}", encoder, layer + 1);
}

Conv2dParameters parameters_of(const Weights& weights, const std::string& layer, int sums) {
  return {weights.values, weights.gradient, weights.value(layer + ".weight").at,
          weights.value(layer + ".bias").at, sums};
}

/// The input of the layers, and their outputs.
using Images = std::array<Buffer<float>, 4>;

std::size_t size_of_images(const Shapes& shapes) {
  return shapes[0].in_size() + shapes[0].out_size() + shapes[1].out_size();
}

std::size_t size_of_gradients(const Shapes& shapes) {
  return shapes[0].grad_out_size() + shapes[1].grad_out_size() + shapes[2].grad_out_size();
}

/// All but the last output, whose place is in the features.
Images allocate_images(Runtime& runtime, const Shapes& shapes) {
  return {runtime.allocate_zeros<float>(shapes[0].in_size()),
          runtime.allocate_zeros<float>(shapes[0].out_size()),
          runtime.allocate_zeros<float>(shapes[1].out_size())};
}

/// Nothing learnable stands before the first layer.
Images allocate_gradients(Runtime& runtime, const Shapes& shapes) {
  return {Buffer<float>(), runtime.allocate_zeros<float>(shapes[0].grad_out_size()),
          runtime.allocate_zeros<float>(shapes[1].grad_out_size()),
          runtime.allocate_zeros<float>(shapes[2].grad_out_size())};
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

/// The first channel of a window that its last frame enters.
int newest_channel(const TactileWindowShape& windows) { return std::max(windows.frames - 2, 0); }

/// A choice, and whether it was tuned.
struct LayerChoice {
  Conv2dChoice choice;
  bool tuned;
};

LayerChoice choice_for(const Conv2dShape& layer, bool training, const Tuning& tuning) {
  const auto* tuned = training ? tuning.layer(layer) : nullptr;
  if (tuned) return {tuned->choice, true};
  return {{method_for(layer, training)}, false};
}

int part_of(const TactileEncoderShape& all, bool training, const Tuning& tuning) {
  const auto* tuned = training ? tuning.part(all.layers()[0]) : nullptr;
  return std::min(all.windows.windows, tuned ? tuned->images : usual_part);
}

void append_marked(Launches& launches, const Launches& more, bool tuned) {
  for (const auto& launch : more) launches.push_back(Launch(launch).tuned(tuned));
}

/// Queues parts so that those of different queues run beside each other.
template <class Parts, class Enqueue>
void share_out(Runtime& runtime, Parts&& parts, Enqueue enqueue_part) {
  const bool several = std::ranges::size(parts) > 1;
  if (several) runtime.fork();
  for (auto& part : parts)
    if (part.queue == 0)
      enqueue_part(part);
    else
      runtime.on_side_queue([&] { enqueue_part(part); });
  if (several) runtime.join();
}

}  // namespace

struct TactileEncoder::Plan {
  struct Part {
    int queue;  ///< 0 or 1: parts of different ones share no array that they write
    TactileWindow window;
    Launches early, forward, backward;  ///< `early`: of one window, see forward_early()
  };

  Plan(Runtime& device, const std::string& name, const TactileEncoderShape& shape,
       const Weights& weights, const Tuning& tuning);
  void add_layer(const Conv2dParameters& parameters, const Conv2dShape& shape,
                 const LayerChoice& choice);
  void add_parts();
  Buffer<float> features_of(int first, int size);
  Part make_part(int first, int size, int queue, const Images& images, const Images& gradients);

  Runtime& runtime;
  TactileEncoderShape all;
  bool training;
  int part_windows;  ///< of the largest part
  Shapes shapes;     ///< of its layers
  Buffer<float> features, grad_features;
  std::vector<std::unique_ptr<Conv2d>> layers;
  std::vector<bool> tuned;  ///< of the layers
  std::vector<Part> parts;
  Launches prepare, finish;
};

TactileEncoder::Plan::Plan(Runtime& device, const std::string& name,
                           const TactileEncoderShape& shape, const Weights& weights,
                           const Tuning& tuning)
    : runtime(device),
      all(shape),
      training(weights.gradient.size() > 0),
      part_windows(part_of(shape, training, tuning)),
      shapes(shape.of_windows(part_windows).layers()),
      features(device.allocate<float>(shape.features().row_size())) {
  const int count = ceil_div(all.windows.windows, part_windows);
  const std::size_t at_once = std::min(count, queues), kept = training ? count : at_once;
  device.check_memory(sizeof(float) * (kept * size_of_images(shapes) +
                                       (training ? at_once * size_of_gradients(shapes) : 0)));
  for (int i = 0; i < 3; ++i)
    add_layer(parameters_of(weights, layer_name(name, i), std::min(count, queues)), shapes[i],
              choice_for(shapes[i], training, tuning));
  if (training) grad_features = device.allocate<float>(features.size());
  add_parts();
}

void TactileEncoder::Plan::add_parts() {
  std::array<Images, queues> images, gradients;
  const int windows = all.windows.windows;
  // Only the first part may be smaller: the backward pass starts with the last.
  int size = (windows - 1) % part_windows + 1;
  for (int first = 0; first < windows; first += size, size = part_windows) {
    const auto number = parts.size();
    const auto queue = number % queues;
    if (training || number < queues) images[queue] = allocate_images(runtime, shapes);
    if (training && number < queues) gradients[queue] = allocate_gradients(runtime, shapes);
    images[queue][3] = features_of(first, size);
    parts.push_back(
        make_part(first, size, static_cast<int>(queue), images[queue], gradients[queue]));
  }
}

Buffer<float> TactileEncoder::Plan::features_of(int first, int size) {
  const auto window = shapes[2].out_size() / std::size_t(part_windows);
  return runtime.sub_buffer(features, first * window, size * window);
}

void TactileEncoder::Plan::add_layer(const Conv2dParameters& parameters, const Conv2dShape& shape,
                                     const LayerChoice& choice) {
  layers.push_back(make_conv2d(runtime, shape, parameters, choice.choice));
  tuned.push_back(choice.tuned);
  append_marked(prepare, layers.back()->prepare(), choice.tuned);
  if (training) append_marked(finish, layers.back()->finish(), choice.tuned);
}

TactileEncoder::Plan::Part TactileEncoder::Plan::make_part(int first, int size, int queue,
                                                           const Images& images,
                                                           const Images& gradients) {
  const auto shape = all.of_windows(size);
  const auto last = shape.features();
  Part part{queue, TactileWindow(runtime, shape.windows, images[0], first), {}, {}, {}};
  const bool starts_sums = first + size + (queues - 1) * part_windows >= all.windows.windows;
  const auto of_layer = [&](int i) {
    return Conv2dImages{size, images[i], images[i + 1], gradients[i + 1], gradients[i], queue};
  };
  auto first_layer = all.windows.windows == 1 && !training
                         ? layers[0]->forward_halves(of_layer(0), newest_channel(all.windows))
                         : Conv2dHalves{{}, layers[0]->forward(of_layer(0))};
  part.early = std::move(first_layer.first);
  append_marked(part.forward, first_layer.second, tuned[0]);
  for (int i = 1; i < 3; ++i)
    append_marked(part.forward, layers[i]->forward(of_layer(i)), tuned[i]);
  if (training)
    part.backward = {block_gradient(runtime, last, features, grad_features, gradients[3], first)};
  for (int i = 2; training && i >= 0; --i)
    append_marked(part.backward, layers[i]->backward(of_layer(i), starts_sums), tuned[i]);
  return part;
}

TactileEncoderShape TactileEncoderShape::of_windows(int count) const {
  auto shape = *this;
  shape.windows.windows = count;
  shape.windows.halo = kernel / 2;
  return shape;
}

LiveTaxels live_taxels(std::span<const float> stream, std::size_t taxels) {
  LiveTaxels live(taxels, 0);
  for (std::size_t i = 0; i < stream.size(); ++i)
    if (stream[i] != 0.0f) live[i % taxels] = 1;
  return live;
}

std::array<Conv2dShape, 3> TactileEncoderShape::layers() const {
  check(windows);
  Shapes layers{};
  Conv2dShape layer{
      windows.windows, windows.frames, windows.rows, windows.cols, 0, true, kernel, 0};
  for (int i = 0; i < 3; ++i) {
    layer.out_channels = channels[i], layer.stride = strides[i];
    layers[i] = layer;
    layer.in_channels = channels[i], layer.in_planes = false;
    layer.rows = layers[i].out_rows(), layer.cols = layers[i].out_cols();
  }
  layers[2].compact_output = true;
  layers[0].dead = worthwhile_dead_pixels(layers[0], live);
  return layers;
}

ChannelBlocksShape TactileEncoderShape::features() const {
  const auto last = layers()[2];
  return {last.images, last.out_channels, last.out_rows(), last.out_cols(), last.halo()};
}

void TactileEncoder::declare(const std::string& name, const TactileEncoderShape& shape,
                             ParameterTable& table) {
  const auto layers = shape.layers();
  for (int i = 0; i < 3; ++i) {
    const int in = layers[i].in_channels, out = layers[i].out_channels, kernel = shape.kernel;
    const Initial initial{0.0, 1.0 / std::sqrt(double(in) * layers[i].taps())};
    const auto layer = layer_name(name, i);
    table.add(layer + ".weight", {out, in, kernel, kernel}, initial);
    table.add(layer + ".bias", {out}, initial);
  }
}

Conv2dChoice TactileEncoder::usual_choice(const Conv2dShape& layer) {
  return {method_for(layer, true)};
}

TactileEncoder::TactileEncoder(Runtime& runtime, const std::string& name,
                               const TactileEncoderShape& shape, const Weights& weights,
                               const Tuning& tuning)
    : plan_(std::make_unique<Plan>(runtime, name, shape, weights, tuning)) {}

TactileEncoder::~TactileEncoder() = default;

const Buffer<float>& TactileEncoder::features() const { return plan_->features; }

void TactileEncoder::prepare() { enqueue(plan_->runtime, plan_->prepare); }

void TactileEncoder::forward(const Buffer<float>& stream, const Buffer<int>& last_frame,
                             const TaxelDropout& dropout) {
  share_out(plan_->runtime, plan_->parts, [&](Plan::Part& part) {
    part.window.enqueue(plan_->runtime, stream, last_frame, dropout);
    enqueue(plan_->runtime, part.early);
    enqueue(plan_->runtime, part.forward);
  });
}

void TactileEncoder::forward_early(const Buffer<float>& stream, const Buffer<int>& last_frame) {
  auto& part = plan_->parts.front();
  part.window.enqueue(plan_->runtime, stream, last_frame, {});
  enqueue(plan_->runtime, part.early);
}

void TactileEncoder::forward_late(const Buffer<float>& stream, const Buffer<int>& last_frame) {
  auto& part = plan_->parts.front();
  part.window.enqueue(plan_->runtime, stream, last_frame, {}, newest_channel(plan_->all.windows));
  enqueue(plan_->runtime, part.forward);
}

const Buffer<float>& TactileEncoder::grad_features() const { return plan_->grad_features; }

void TactileEncoder::backward() {
  // The last part's images are those that the cache may still hold.
  share_out(plan_->runtime, plan_->parts | std::views::reverse,
            [&](const Plan::Part& part) { enqueue(plan_->runtime, part.backward); });
  enqueue(plan_->runtime, plan_->finish);
}

}  // namespace touchtrace
