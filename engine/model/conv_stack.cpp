#include "engine/model/conv_stack.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ranges>

namespace touchtrace {
namespace {

constexpr int num_queues = 2;
using Shapes = std::array<Conv2dShape, 3>;

std::string layer_name(const std::string& encoder, int layer) {
  return fmt::format("{}.conv{}", encoder, layer + 1);
}

Conv2dParameters parameters_of(const Weights& weights, const std::string& layer, int sums) {
  return {weights.values, weights.gradient, weights.value(layer + ".weight").at,
          weights.value(layer + ".bias").at, sums};
}

/// Input of the first layer, then the output of each layer.
using Images = std::array<Buffer<float>, 4>;

/// Floats of allocate_images().
std::size_t size_of_images(const Shapes& shapes) {
  return shapes[0].in_size() + shapes[0].out_size() + shapes[1].out_size();
}

/// Floats of allocate_gradients().
std::size_t size_of_gradients(const Shapes& shapes) {
  return shapes[0].grad_out_size() + shapes[1].grad_out_size() + shapes[2].grad_out_size();
}

/// The last output is a sub-buffer of the features.
Images allocate_images(Runtime& runtime, const Shapes& shapes) {
  return {runtime.allocate_zeros<float>(shapes[0].in_size()),
          runtime.allocate_zeros<float>(shapes[0].out_size()),
          runtime.allocate_zeros<float>(shapes[1].out_size())};
}

/// No gradient of the first input: it depends on no parameter.
Images allocate_gradients(Runtime& runtime, const Shapes& shapes) {
  return {Buffer<float>(), runtime.allocate_zeros<float>(shapes[0].grad_out_size()),
          runtime.allocate_zeros<float>(shapes[1].grad_out_size()),
          runtime.allocate_zeros<float>(shapes[2].grad_out_size())};
}

/// In training, Winograd weights are transformed at every update, which pays from about 32 images
/// on. Prediction handles few windows at a time and is limited by reading weights, which should
/// stay in the second-level cache; and its result must not depend on the number of windows.
Conv2dMethod method_for(const Conv2dShape& shape, bool training) {
  constexpr int min_images = 32;
  constexpr std::size_t cached_floats = 1u << 18, winograd_sets_per_tap = 4;
  const bool pays = training ? shape.images >= min_images
                             : winograd_sets_per_tap * shape.weight_size() <= cached_floats;
  return pays ? best_method(shape) : Conv2dMethod::direct;
}

/// Enqueues each micro-batch on its own queue; the two queues run concurrently.
template <class MicroBatches, class Enqueue>
void enqueue_interleaved(Runtime& runtime, MicroBatches&& batches, Enqueue enqueue_one) {
  const bool several = std::ranges::size(batches) > 1;
  if (several) runtime.fork();
  for (auto& batch : batches)
    if (batch.queue == 0)
      enqueue_one(batch);
    else
      runtime.on_side_queue([&] { enqueue_one(batch); });
  if (several) runtime.join();
}

}  // namespace

struct ConvStack::Impl {
  struct MicroBatch {
    int queue;  ///< 0 or 1; micro-batches of different queues share no array that they write
    TactileWindow window;
    Launches forward, backward;
  };

  Impl(Runtime& device, const std::string& name, const ConvStackShape& shape,
       const Weights& weights);
  void add_layer(const Conv2dParameters& parameters, const Conv2dShape& shape);
  void add_micro_batches();
  Buffer<float> features_of(int first, int size);
  MicroBatch make_micro_batch(int first, int size, int queue, const Images& images,
                              const Images& gradients);

  Runtime& runtime;
  ConvStackShape all;
  bool training;
  int batch_windows;  ///< of the largest micro-batch
  Shapes shapes;      ///< for batch_windows windows
  Buffer<float> features, grad_features;
  std::vector<std::unique_ptr<Conv2d>> layers;
  std::vector<MicroBatch> micro_batches;
  Launches prepare, finish;
};

ConvStack::Impl::Impl(Runtime& device, const std::string& name, const ConvStackShape& shape,
                      const Weights& weights)
    : runtime(device),
      all(shape),
      training(weights.gradient.size() > 0),
      batch_windows(std::min(shape.windows.windows, device.kernel_variant() == KernelVariant::gpu
                                                        ? gpu_micro_batch_windows
                                                        : micro_batch_windows)),
      shapes(shape.of_windows(batch_windows).layers()),
      features(device.allocate<float>(shape.features().row_size())) {
  const int count = (all.windows.windows + batch_windows - 1) / batch_windows;
  const std::size_t concurrent = std::min(count, num_queues),
                    image_sets = training ? count : concurrent;
  device.check_memory(sizeof(float) * (image_sets * size_of_images(shapes) +
                                       (training ? concurrent * size_of_gradients(shapes) : 0)));
  for (int i = 0; i < 3; ++i)
    add_layer(parameters_of(weights, layer_name(name, i), std::min(count, num_queues)), shapes[i]);
  if (training) grad_features = device.allocate<float>(features.size());
  add_micro_batches();
}

void ConvStack::Impl::add_micro_batches() {
  std::array<Images, num_queues> images, gradients;
  const int windows = all.windows.windows;
  // Only the first micro-batch may be smaller, since the backward pass starts with the last.
  int size = (windows - 1) % batch_windows + 1;
  for (int first = 0; first < windows; first += size, size = batch_windows) {
    const auto number = micro_batches.size();
    const auto queue = number % num_queues;
    if (training || number < num_queues) images[queue] = allocate_images(runtime, shapes);
    if (training && number < num_queues) gradients[queue] = allocate_gradients(runtime, shapes);
    images[queue][3] = features_of(first, size);
    micro_batches.push_back(
        make_micro_batch(first, size, static_cast<int>(queue), images[queue], gradients[queue]));
  }
}

Buffer<float> ConvStack::Impl::features_of(int first, int size) {
  const auto window = shapes[2].out_size() / std::size_t(batch_windows);
  return runtime.sub_buffer(features, first * window, size * window);
}

void ConvStack::Impl::add_layer(const Conv2dParameters& parameters, const Conv2dShape& shape) {
  layers.push_back(make_conv2d(runtime, shape, parameters, method_for(shape, training)));
  append(prepare, layers.back()->prepare());
  if (training) append(finish, layers.back()->finish());
}

ConvStack::Impl::MicroBatch ConvStack::Impl::make_micro_batch(int first, int size, int queue,
                                                              const Images& images,
                                                              const Images& gradients) {
  const auto shape = all.of_windows(size);
  const auto last = shape.features();
  MicroBatch batch{queue, TactileWindow(runtime, shape.windows, images[0], first), {}, {}};
  // The backward pass starts with the last num_queues micro-batches, one per queue.
  const bool is_first_backward =
      first + size + (num_queues - 1) * batch_windows >= all.windows.windows;
  const auto of_layer = [&](int i) {
    return Conv2dMicroBatch{size, images[i], images[i + 1], gradients[i + 1], gradients[i], queue};
  };
  for (int i = 0; i < 3; ++i) append(batch.forward, layers[i]->forward(of_layer(i)));
  if (training)
    batch.backward = {block_gradient(runtime, last, features, grad_features, gradients[3], first)};
  for (int i = 2; training && i >= 0; --i)
    append(batch.backward, layers[i]->backward(of_layer(i), is_first_backward));
  return batch;
}

void ConvStack::declare(const std::string& name, const ConvStackShape& shape,
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

ConvStack::ConvStack(Runtime& runtime, const std::string& name, const ConvStackShape& shape,
                     const Weights& weights)
    : impl_(std::make_unique<Impl>(runtime, name, shape, weights)) {}

ConvStack::~ConvStack() = default;

const Buffer<float>& ConvStack::features() const { return impl_->features; }

const Buffer<float>& ConvStack::grad_features() const { return impl_->grad_features; }

void ConvStack::prepare() { enqueue(impl_->runtime, impl_->prepare); }

void ConvStack::forward(const Buffer<float>& stream, const Buffer<int>& window_end,
                        const TaxelDropout& dropout) {
  enqueue_interleaved(impl_->runtime, impl_->micro_batches, [&](Impl::MicroBatch& batch) {
    batch.window.enqueue(impl_->runtime, stream, window_end, dropout);
    enqueue(impl_->runtime, batch.forward);
  });
}

void ConvStack::backward() {
  // In reverse, since the cache may still hold the images of the last micro-batch.
  enqueue_interleaved(
      impl_->runtime, impl_->micro_batches | std::views::reverse,
      [&](const Impl::MicroBatch& batch) { enqueue(impl_->runtime, batch.backward); });
  enqueue(impl_->runtime, impl_->finish);
}

}  // namespace touchtrace
