#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"
#include "engine/train/noise_batch.h"
#include "engine/train/predictor.h"
#include "engine/train/trainer.h"
#include "tests/engine/small_spec.h"

namespace touchtrace::testing {

/// Fixture with a scratch folder and the default device.
class TrainerTest : public ::testing::Test {
 protected:
  ScratchFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
  Runtime runtime_{choose_device("")};
};

/// Training on random data that uses every state that a resumed run must restore.
struct NoiseRun {
  static constexpr int sequences = 3, steps = 4, frames = 40;

  NoiseRun(Runtime& runtime, bool touch, const TrainOptions& how = options())
      : NoiseRun(runtime, small_spec(touch), how) {}
  NoiseRun(Runtime& runtime, const ModelSpec& model, const TrainOptions& how = options())
      : spec(model), trainer(runtime, spec, how, sequences, steps, stream(spec)) {}

  static TrainOptions options() {
    TrainOptions o;
    o.updates = 12;
    return o;
  }
  static std::vector<float> stream(const ModelSpec& spec) {
    RandomStream random(1, "stream");
    return noise_stream(spec, frames, random);
  }
  /// Batch of the next update.
  RolloutBatch batch() const {
    RandomStream random(trainer.updates(), "batch");
    return noise_batch(spec, sequences, steps, frames, random);
  }
  void train_until(int update) {
    while (trainer.updates() < update) trainer.update(batch());
  }
  std::string weights(const std::filesystem::path& path) {
    trainer.save(path, {}, true);
    return read_file(path);
  }

  ModelSpec spec;
  Trainer trainer;
};

}  // namespace touchtrace::testing
