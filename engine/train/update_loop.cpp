#include "engine/train/update_loop.h"

#include <fmt/core.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/finite.h"
#include "engine/cl/launch_inspection.h"
#include "engine/train/schedule.h"

namespace touchtrace {
UpdateLoop::UpdateLoop(Runtime& runtime, const TrainOptions& options, const Weights& weights,
                       const Buffer<float>& loss, Names names, std::span<const float> tactile)
    : runtime_(runtime),
      options_(options),
      weights_(weights),
      loss_(loss),
      stream_(runtime.upload(tactile)),
      names_(std::move(names)),
      dropout_keys_(options.seed, names_.dropout_stream),
      adam_(runtime, weights.values, weights.gradient,
            decays(runtime, weights.table, options.weight_decay), loss) {
  runtime.write<float>(weights.values, weights.table.initial_values(options.seed));
}

UpdateLoop::Keys UpdateLoop::keys() const {
  return dropout_keys_.block(static_cast<std::uint64_t>(counts_.attempted));
}

double UpdateLoop::update(const Functions& functions) {
  functions.pass(keys());
  adam_.enqueue({counts_.attempted - counts_.skipped + 1,
                 learning_rate(options_, counts_.attempted), options_.clip_norm});
  const float loss = runtime_.download(loss_)[0], norm = runtime_.download(adam_.norm())[0];
  if (!std::isfinite(loss) || !std::isfinite(norm)) return skip(functions);
  ++counts_.attempted;
  counts_.consecutive_skips = 0;
  return loss;
}

double UpdateLoop::skip(const Functions& functions) {
  const auto problem = fmt::format("{} {}: {} not finite", names_.update, counts_.attempted + 1,
                                   find_cause(functions));
  if (counts_.consecutive_skips >= options_.max_consecutive_skips)
    throw failure(problem,
                  "lower --learning-rate, look for extreme values in labels and tactile frames, or "
                  "skip such updates with --skip-not-finite; the weights are those before this "
                  "update");
  fmt::print(stderr, "warning: {}; update skipped\n", problem);
  ++counts_.attempted, ++counts_.skipped, ++counts_.consecutive_skips;
  return std::nan("");
}

std::string UpdateLoop::find_cause(const Functions& functions) {
  if (const auto input = functions.invalid_input(); !input.empty()) return input + " are";
  if (!all_finite(runtime_.download(weights_.values))) return "the weights are";
  if (!all_finite(runtime_.download(stream_))) return "the tactile frames are";
  const auto kernel = first_non_finite_kernel(runtime_, [&] { functions.pass(keys()); });
  return kernel.empty() ? "the gradient norm is" : fmt::format("the output of {} is", kernel);
}

}  // namespace touchtrace
