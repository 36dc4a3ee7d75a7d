#include <fmt/core.h>

#include "engine/train/noise_training.h"
#include "tests/verify/engine/verify_engine.h"
#include "tests/verify/verifications.h"

namespace touchtrace {
namespace {

using Emit = std::function<void(Figure)>;

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
  for (int sequences : {8, 32}) {
    verify_step(runtime, "touch", {}, sequences, emit);
    verify_step(runtime, "both encoders", {.object = ObjectEncoder::joint}, sequences, emit);
    verify_step(runtime, "touch, GRU", {.dynamics = DynamicsKind::gru}, sequences, emit);
  }
  verify_step(runtime, "no touch", {.touch = false}, 8, emit);
}

}  // namespace touchtrace
