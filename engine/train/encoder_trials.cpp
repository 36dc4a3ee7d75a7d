#include "engine/train/encoder_trials.h"

#include <numeric>

#include "engine/base/random.h"
#include "engine/check/host_arrays.h"
#include "engine/check/operation_check.h"
#include "engine/train/noise_batch.h"

namespace touchtrace {
namespace {

constexpr TaxelDropout dropout{0.2, 1};
constexpr int num_queues = 2;  // of ConvStack

ParameterTable parameters_of(const ConvStackShape& shape) {
  ParameterTable table;
  ConvStack::declare("encoder", shape, table);
  return table;
}

std::vector<float> normal_noise(std::size_t size, const char* name) {
  RandomStream random(1, name);
  return normal_floats(size, random);
}

std::size_t stream_size(const TactileWindowShape& windows) {
  return std::size_t(windows.windows + windows.frames) * windows.rows * windows.cols;
}

/// Window w ends at frame M - 1 + w.
std::vector<int> window_ends(const TactileWindowShape& windows) {
  std::vector<int> last(static_cast<std::size_t>(windows.windows));
  std::iota(last.begin(), last.end(), windows.frames - 1);
  return last;
}

}  // namespace

EncoderTrials::EncoderTrials(Runtime& runtime, const ConvStackShape& shape)
    : runtime_(runtime),
      shape_(shape),
      table_(parameters_of(shape)),
      weights_{table_, runtime.upload<float>(table_.initial_values(1)),
               runtime.allocate_zeros<float>(table_.size())},
      stream_(runtime.upload<float>(normal_noise(stream_size(shape.windows), "stream"))),
      window_end_(runtime.upload<int>(window_ends(shape.windows))) {}

std::optional<Trial> EncoderTrials::make(const Tuning& tuning) {
  return make_if_supported(!reference_, [&]() -> std::optional<Trial> {
    const auto encoder = std::make_shared<ConvStack>(runtime_, "encoder", shape_, weights_, tuning);
    runtime_.write<float>(encoder->grad_features(),
                          normal_noise(encoder->grad_features().size(), "gradient"));
    const auto now = results(*encoder);
    if (!reference_) reference_ = now;
    if (now.features != reference_->features ||
        !(norm_error(now.gradient, reference_->gradient) <= 2 * gradient_error_bound))
      return std::nullopt;
    return make_trial(
        runtime_, [this, encoder] { pass(*encoder); }, num_queues);
  });
}

void EncoderTrials::pass(ConvStack& encoder) const {
  encoder.prepare();
  encoder.forward(stream_, window_end_, dropout);
  encoder.backward();
}

EncoderTrials::Results EncoderTrials::results(ConvStack& encoder) const {
  runtime_.fill(weights_.gradient, 0.0f);
  pass(encoder);
  return {runtime_.download(encoder.features()), download(runtime_, weights_.gradient)};
}

}  // namespace touchtrace
