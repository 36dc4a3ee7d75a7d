#include "tests/verify/engine/model_comparison.h"

#include <algorithm>
#include <cmath>

#include "engine/check/operation_check.h"
#include "engine/train/batch_rows.h"
#include "engine/train/noise_batch.h"

namespace touchtrace {
namespace {

// More than float rounding changes a pre-activation by over 20 steps.
constexpr double kink_margin = 2e-6;
constexpr double object_loss =
    0.3;  ///< lambda_obj; large enough that both terms of the loss matter

std::vector<double> as_double(const std::vector<float>& values) {
  return {values.begin(), values.end()};
}

/// [S, T, state] as [T, S, state].
std::vector<double> by_step(const std::vector<float>& values, int sequences, int steps, int state) {
  std::vector<double> rows;
  for (int t = 0; t < steps; ++t)
    for (int s = 0; s < sequences; ++s) {
      const auto row = values.begin() + (std::ptrdiff_t(s) * steps + t) * state;
      rows.insert(rows.end(), row, row + state);
    }
  return rows;
}

}  // namespace

double ModelComparison::loss_error() const {
  return std::abs(device.loss - reference.loss) / reference.loss;
}

double ModelComparison::gradient_error() const {
  return norm_error(device.gradient, reference.gradient);
}

ModelComparison compare_model(Runtime& runtime, const ModelSpec& spec, int sequences, int steps,
                              const TaxelDropout& dropout, std::uint64_t seed,
                              const std::function<float(float)>& frame_value) {
  RandomStream random(seed, "model comparison");
  const int frames = spec.window_frames + 2 * steps;
  Model model(runtime, spec, sequences, steps, Model::Use::training);
  auto stream = noise_stream(spec, frames, random);
  if (frame_value) std::ranges::transform(stream, stream.begin(), frame_value);
  const auto parameters = model.table().initial_values(seed);
  const auto batch = noise_batch(spec, sequences, steps, frames, random);
  runtime.write<float>(model.weights().values, parameters);
  write_windows(runtime, model, batch);
  write_initial_states(runtime, model, {batch}, batch.initial_state);
  write_targets(runtime, model, batch);
  write_segments(runtime, model, batch, object_loss);
  model.prepare();
  const TaxelDropout segment_dropout{dropout.share, dropout.key + 1};
  model.forward(runtime.upload<float>(stream), dropout, segment_dropout);
  model.backward();

  ModelComparison result{model.table(), {}, {}, as_double(parameters), {}};
  result.device = {runtime.download(model.loss())[0],
                   as_double(runtime.download(model.weights().gradient)), 0.0};
  result.problem = {.sequences = sequences,
                    .steps = steps,
                    .stream = as_double(stream),
                    .window_end = runtime.download(model.input().window_end),
                    .initial = as_double(batch.initial_state),
                    .target = by_step(batch.target, sequences, steps, spec.state),
                    .weight = as_double(runtime.download(model.input().weight)),
                    .dropout = dropout,
                    .segment_end = runtime.download(model.input().segment_end),
                    .object = runtime.download(model.input().object),
                    .contrast_weight = as_double(runtime.download(model.input().contrast_weight)),
                    .segment_dropout = segment_dropout};
  result.reference = model_reference(spec, result.table, result.parameters, result.problem);
  return result;
}

ModelComparison compare_away_from_kinks(Runtime& runtime, const ModelSpec& spec, int sequences,
                                        int steps, std::uint32_t& seed,
                                        const std::function<float(float)>& frame_value) {
  for (;; ++seed) {
    auto result = compare_model(runtime, spec, sequences, steps, {0.2, seed}, seed, frame_value);
    if (!(result.reference.kink_distance <= kink_margin)) return result;
  }
}

}  // namespace touchtrace
