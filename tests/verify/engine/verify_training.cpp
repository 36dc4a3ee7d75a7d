#include <fmt/core.h>

#include <random>

#include "engine/train/noise_training.h"
#include "tests/verify/engine/model_comparison.h"
#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {
namespace {

using Emit = std::function<void(Figure)>;

/// `kind`: specification with other sizes than those used here.
void verify_gradient(Runtime& runtime, const char* name, const ModelSpec& kind, int sequences,
                     const Emit& emit) {
  std::uint32_t seed = std::random_device{}();
  ModelSpec spec = kind;
  spec.window_frames = 4, spec.rows = spec.cols = 12, spec.hidden = 64;
  const auto result = compare_away_from_kinks(runtime, spec, sequences, 20, seed);
  emit(at_most(fmt::format("{}, 20 steps, loss against double, seed {}", name, seed),
               result.loss_error(), "relative", 1e-5));
  emit(at_most(fmt::format("{}, 20 steps, gradient against double", name), result.gradient_error(),
               "relative", 1e-5));
}

/// Mean CPU milliseconds of `count` updates.
double update_ms(NoiseTraining& training, int count) {
  const Stopwatch stopwatch;
  for (int i = 0; i < count; ++i) training.update();
  return 1e3 * stopwatch.cpu_seconds() / count;
}

void verify_step(Runtime& runtime, const char* name, const ModelSpec& spec, int sequences,
                 const Emit& emit) {
  NoiseTraining training(runtime, spec, sequences, 20);
  update_ms(training, 3);
  emit(reported(fmt::format("training step, {} sequences x 20 steps, {}", sequences, name),
                update_ms(training, 160 / sequences), "CPU-ms"));
}

}  // namespace

Verification verify_first_step() {
  return [](const Emit& emit) {
    Runtime runtime(choose_device(""));
    emit(reported("loss of the first update", NoiseTraining(runtime, {}, 8, 20).update(), ""));
  };
}

void verify_training(const Emit& emit) {
  Runtime runtime(choose_device(""));
  verify_gradient(runtime, "whole model", {}, 2, emit);
  verify_gradient(runtime, "whole model with both encoders", {.object = ObjectEncoder::joint}, 4,
                  emit);
  verify_gradient(runtime, "whole model with SiLU", {.activation = Activation::silu}, 2, emit);
  verify_gradient(runtime, "whole model with tanh", {.activation = Activation::tanh}, 2, emit);
  verify_gradient(runtime, "whole model with a GRU",
                  {.object = ObjectEncoder::joint, .dynamics = DynamicsKind::gru}, 4, emit);
  for (int sequences : {8, 32}) {
    verify_step(runtime, "touch", {}, sequences, emit);
    verify_step(runtime, "both encoders", {.object = ObjectEncoder::joint}, sequences, emit);
    verify_step(runtime, "touch, GRU", {.dynamics = DynamicsKind::gru}, sequences, emit);
  }
  verify_step(runtime, "no touch", {.touch = false}, 8, emit);
}

}  // namespace touchtrace
