#include "engine/train/layer_trials.h"

#include <algorithm>
#include <iterator>

#include "engine/base/random.h"
#include "engine/check/host_arrays.h"
#include "engine/check/operation_check.h"
#include "engine/train/noise_batch.h"

namespace touchtrace {
namespace {

std::vector<double> noise(std::size_t size, const char* name) {
  RandomStream random(1, name);
  const auto values = normal_floats(size, random);
  return {values.begin(), values.end()};
}

/// Like the output of a ReLU.
std::vector<double> positive_noise(std::size_t size, const char* name) {
  auto values = noise(size, name);
  for (auto& value : values) value = std::max(value, 0.0);
  return values;
}

}  // namespace

bool agree(const Conv2dShape& shape, const LayerResults& results, const LayerResults& reference) {
  const double terms = static_cast<double>(shape.taps()) * shape.in_channels;
  return array_error(results.out, reference.out, terms) <= 2 * output_error_bound &&
         norm_error(results.grad_in, reference.grad_in) <= 2 * gradient_error_bound &&
         norm_error(results.gradient, reference.gradient) <= 2 * gradient_error_bound;
}

LayerTrials::LayerTrials(Runtime& runtime, const Conv2dShape& s, int micro_batches)
    : runtime_(runtime), shape_(s) {
  const auto parameters = s.weight_size() + s.out_channels;
  parameters_ = {upload(runtime, noise(parameters, "weights")),
                 runtime.allocate_zeros<float>(parameters), 0, static_cast<int>(s.weight_size())};
  const HaloLayout in{s.rows, s.cols, s.in_planes ? 1 : 16, s.halo()},
      out{s.out_rows(), s.out_cols(), 16, s.halo()};
  const auto images = with_halo(
      positive_noise(std::size_t(s.images) * s.in_channels * in.rows * in.cols, "in"), in);
  const auto gradient =
      with_halo(noise(std::size_t(s.images) * s.out_channels * out.rows * out.cols, "out"), out);
  for (int i = 0; i < micro_batches; ++i)
    micro_batches_.push_back(
        {s.images, upload(runtime, images), runtime.allocate_zeros<float>(s.out_size()),
         upload(runtime, gradient), runtime.allocate_zeros<float>(s.in_planes ? 0 : s.in_size())});
}

std::optional<Trial> LayerTrials::make(const Conv2dChoice& choice) {
  return make_if_supported(!reference_, [&]() -> std::optional<Trial> {
    const std::shared_ptr<Conv2d> layer = make_conv2d(runtime_, shape_, parameters_, choice);
    const auto launches = pass(*layer);
    const auto now = results(launches);
    if (!reference_) reference_ = now;
    if (!agree(shape_, now, *reference_)) return std::nullopt;
    return make_trial(
        runtime_, [this, layer, launches] { enqueue(runtime_, launches); },
        std::min<int>(2, micro_batches_.size()));
  });
}

Launches LayerTrials::pass(Conv2d& layer) const {
  Launches launches = layer.prepare();
  const auto add = [&](const Launches& more) {
    std::ranges::copy(more, std::back_inserter(launches));
  };
  for (const auto& batch : micro_batches_) add(layer.forward(batch));
  for (const auto& batch : micro_batches_)
    add(layer.backward(batch, &batch == &micro_batches_.front()));
  add(layer.finish());
  return launches;
}

LayerResults LayerTrials::results(const Launches& launches) {
  runtime_.fill(parameters_.gradient, 0.0f);
  enqueue(runtime_, launches);
  const auto& last = micro_batches_.back();
  return {download(runtime_, last.out), download(runtime_, last.grad_in),
          download(runtime_, parameters_.gradient)};
}

}  // namespace touchtrace
