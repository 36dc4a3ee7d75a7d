#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "engine/base/scratch_folder.h"
#include "engine/check/operation_check.h"
#include "engine/cl/timing.h"
#include "engine/train/batch_rows.h"
#include "engine/train/noise_batch.h"
#include "engine/train/predictor.h"
#include "tests/verify/engine/model_comparison.h"
#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {
namespace {

/// Model of an extreme size or on extreme frames, small enough for plain loops.
struct ExtremeModel {
  const char* name;
  ModelSpec spec;
  int sequences, steps;
  std::function<float(float)> frame_value;
};

std::vector<ExtremeModel> extreme_models() {
  const ModelSpec normal{.window_frames = 3, .rows = 12, .cols = 12, .hidden = 64};
  const ModelSpec one{
      .window_frames = 1, .rows = 7, .cols = 13, .embedding = 16, .hidden = 64, .state = 1};
  const ModelSpec many{.window_frames = 32,
                       .rows = 9,
                       .cols = 6,
                       .embedding = 48,
                       .hidden = 128,
                       .state = 16,
                       .band_quantile = 0.3,
                       .activation = Activation::silu};
  ModelSpec fine{.window_frames = 3, .rows = 6, .cols = 6, .hidden = 64}, wide = one;
  fine.tactile_strides = {1, 1, 1};
  wide.tactile_kernel = 5;
  return {
      {"frames of zeros", normal, 2, 6, [](float) { return 0.0f; }},
      {"constant frames", normal, 2, 6, [](float) { return 0.37f; }},
      {"saturated frames", normal, 2, 6, [](float v) { return v > 0 ? 1023.0f : 0.0f; }},
      {"subnormal frames", normal, 2, 6, [](float v) { return 1e-39f * v; }},
      {"1 sequence, 1 step, M = 1, 7 x 13", one, 1, 1, {}},
      {"5 sequences, 3 steps, M = 32, 9 x 6, Q = 0.3, SiLU", many, 5, 3, {}},
      {"2 sequences, 1 step, 6 x 6, strides of 1", fine, 2, 1, {}},
      {"2 sequences, 2 steps, 7 x 13, 5 x 5 taps", wide, 2, 2, {}},
  };
}

double larger(double a, double b) { return !(b <= a) ? b : a; }

void verify_model(Runtime& runtime, const ExtremeModel& extreme,
                  const std::function<void(Figure)>& emit) {
  std::uint32_t seed = std::random_device{}();
  const auto result = compare_away_from_kinks(runtime, extreme.spec, extreme.sequences,
                                              extreme.steps, seed, extreme.frame_value);
  emit(at_most(fmt::format("{}, loss and gradient against double", extreme.name),
               larger(result.loss_error(), result.gradient_error()), "relative", 1e-5));
}

/// Inputs of the state loss at which states or quantiles equal the targets: L1 and the two pinball
/// terms are at their kinks, one at a time and all at once.
Arrays inputs_at_kinks(const OperationCase& loss) {
  Arrays in;
  for (const auto size : loss.input_sizes) in.emplace_back(size, 1.0);
  for (std::size_t i = 0; i < in[0].size(); ++i) {
    const double off[] = {0.0, 0.0, 0.5, -0.5}, spread[] = {0.0, 0.25, 0.5, 0.5};
    in[0][i] = 0.5 + off[i % 4], in[1][i] = spread[i % 4], in[2][i] = 0.5;
  }
  return in;
}

void verify_kinks(Runtime& runtime, const std::function<void(Figure)>& emit) {
  const auto& table = operations();
  const auto& loss = *std::ranges::find(table, "state_loss", &Operation::name);
  double gradient = 0.0, difference = 0.0;
  for (const auto& at : loss.cases) {
    const auto in = inputs_at_kinks(at);
    gradient = larger(gradient, gradient_error(runtime, at, in, 1));
    difference = larger(difference, reference_gradient_error(at, in, 1));
  }
  emit(at_most("gradient of L1 and pinball at their kinks, kernel against reference", gradient,
               "relative", gradient_error_bound));
  emit(at_most("the same, reference against the mean of both sides' slopes", difference, "relative",
               reference_gradient_bound));
}

/// Training pass of the default model on random data times `scale`.
class Pass {
 public:
  Pass(Runtime& runtime, float scale)
      : runtime_(runtime), model_(runtime, ModelSpec{}, 8, 20, Model::Use::training) {
    RandomStream random(1, "verify extremes");
    const int frames = 64;
    auto batch = noise_batch(model_.spec(), 8, 20, frames, random);
    auto weights = model_.table().initial_values(1);
    auto stream = noise_stream(model_.spec(), frames, random);
    for (auto* values : {&batch.initial_state, &batch.target, &weights, &stream})
      for (float& value : *values) value *= scale;
    stream_ = runtime.upload<float>(stream);
    runtime.write<float>(model_.weights().values, weights);
    write_windows(runtime, model_, batch);
    write_initial_states(runtime, model_, {batch}, batch.initial_state);
    write_targets(runtime, model_, batch);
  }
  double seconds() {
    return median_seconds(runtime_, [&] {
      model_.prepare();
      model_.forward(stream_);
      model_.backward();
    });
  }

 private:
  Runtime& runtime_;
  Model model_;
  Buffer<float> stream_;
};

/// Median ratio of passes on subnormal and on normal numbers, interleaved.
double slowdown_by_subnormals(Runtime& runtime) {
  Pass normal(runtime, 1.0f), subnormal(runtime, 1e-39f);
  std::array<double, 5> ratios{};
  for (double& ratio : ratios) {
    const double normal_s = normal.seconds();
    ratio = subnormal.seconds() / normal_s;
  }
  std::ranges::nth_element(ratios, ratios.begin() + 2);
  return ratios[2];
}

/// States on a circle: sine and cosine of random phase and amplitude.
RolloutBatch rotating_points(int sequences, int steps, RandomStream& random) {
  RolloutBatch batch;
  batch.sequences = sequences, batch.steps = steps;
  for (int s = 0; s < sequences; ++s) {
    const double phase = random.uniform(0.0, 6.28), size = random.uniform(0.1, 2.0);
    const auto add = [&](std::vector<float>& to, int step) {
      for (double lag : {0.0, 1.57}) to.push_back(float(size * std::sin(phase + lag + 0.3 * step)));
    };
    add(batch.initial_state, 0);
    for (int step = 1; step <= steps; ++step) add(batch.target, step);
  }
  return batch;
}

/// Trains a small model without touch on rotating_points() and rolls it out from initial states
/// three times as large. Returns the number of predicted values that are not finite.
double not_finite_in_long_rollouts(Runtime& runtime) {
  constexpr int sequences = 8, steps = 10, count = 300;
  const ScratchFolder folder;
  Trainer trainer(runtime, {.touch = false, .hidden = 64, .state = 2}, {.updates = count},
                  sequences, steps, {});
  RandomStream random(1, "swinging points");
  while (trainer.updates() < count) trainer.update(rotating_points(sequences, steps, random));
  trainer.save(folder.path() / "model", {}, false);

  auto batch = rotating_points(sequences, 500, random);
  batch.target.clear();
  for (float& value : batch.initial_state) value *= 3.0f;
  const auto rollout = Predictor(runtime, folder.path() / "model").predict(batch, {});
  const auto bad = [](float v) { return !std::isfinite(v); };
  return static_cast<double>(std::ranges::count_if(rollout.state, bad) +
                             std::ranges::count_if(rollout.spread, bad));
}

}  // namespace

void verify_extremes(const std::function<void(Figure)>& emit) {
  Runtime runtime(choose_device(""));
  for (const auto& extreme : extreme_models()) verify_model(runtime, extreme, emit);
  verify_kinks(runtime, emit);
  emit(at_most("training pass on subnormal numbers against normal ones",
               slowdown_by_subnormals(runtime), "times", 1.2));
  emit(at_most("values of 500-step roll-outs from 3 times the trained states that are not finite",
               not_finite_in_long_rollouts(runtime), "", 0.0));
}

}  // namespace touchtrace
