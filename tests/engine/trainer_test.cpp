#include "engine/train/trainer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>

#include "engine/base/error.h"
#include "engine/train/safetensors.h"
#include "tests/engine/trainer_fixture.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

using testing::NoiseRun;
using testing::small_spec;
using testing::TrainerTest;

TEST_F(TrainerTest, ResumesBitwise) {
  Runtime exact(choose_device(""), Accuracy::exact);
  for (auto* runtime : {&runtime_, &exact})
    for (const auto& spec : {small_spec(false), small_spec(true), small_spec(ObjectEncoder::joint),
                             testing::with_gru(small_spec(true))}) {
      NoiseRun whole(*runtime, spec);
      whole.train_until(10);
      for (int stop : {1, 7}) {
        NoiseRun killed(*runtime, spec);
        killed.train_until(stop);
        killed.trainer.save_checkpoint(folder_ / "checkpoint", {{"clips", 7}});
        EXPECT_EQ(Trainer::checkpoint_notes(folder_ / "checkpoint").at("clips"), 7);
        NoiseRun resumed(*runtime, spec);
        resumed.train_until(3);
        resumed.trainer.load_checkpoint(folder_ / "checkpoint");
        EXPECT_EQ(resumed.trainer.updates(), stop);
        resumed.train_until(10);
        EXPECT_EQ(resumed.weights(folder_ / "a"), whole.weights(folder_ / "b"));
      }
    }
}

TEST_F(TrainerTest, RejectsCheckpointsOfOtherModels) {
  NoiseRun run(runtime_, false), other(runtime_, true);
  run.train_until(1);
  const auto before = run.weights(folder_ / "before");
  EXPECT_THROW(run.trainer.load_checkpoint(folder_ / "before"), Error)
      << "a model, not a checkpoint";
  other.trainer.save_checkpoint(folder_ / "checkpoint");
  EXPECT_THROW(run.trainer.load_checkpoint(folder_ / "checkpoint"), Error) << "of another model";
  EXPECT_THROW(run.trainer.load_checkpoint(folder_ / "missing"), Error);
  EXPECT_EQ(run.weights(folder_ / "after"), before);
}

TEST_F(TrainerTest, RejectsCheckpointsOfSpecsWithEqualWeightSizes) {
  const auto path = folder_ / "checkpoint";
  NoiseRun(runtime_, small_spec(true)).trainer.save_checkpoint(path);
  auto activation = small_spec(true), quantile = activation, wider = activation;
  activation.activation = Activation::tanh;
  quantile.band_quantile = 0.2;
  wider.cols = 7;  // as many features after the strides
  for (const auto& [spec, key] : {std::pair{activation, "'activation' is \"relu\", here \"tanh\""},
                                  {quantile, "'band_quantile' is 0.1, here 0.2"},
                                  {wider, "'cols' is 6, here 7"}}) {
    NoiseRun run(runtime_, spec);
    const auto message = testing::expect_error([&] { run.trainer.load_checkpoint(path); }, key);
    EXPECT_NE(message.find(path.string()), std::string::npos);
  }
}

TEST_F(TrainerTest, RejectsCheckpointsWithInvalidCounts) {
  const auto path = folder_ / "checkpoint";
  NoiseRun run(runtime_, false);
  run.trainer.save_checkpoint(path);
  const auto good = read_safetensors(path);
  for (const char* value : {"-1", "1.5", "4294967296", "\"1\"", "null"}) {
    auto file = good;
    auto training = nlohmann::json::parse(file.metadata.at("training"));
    training["attempted"] = nlohmann::json::parse(value);
    file.metadata["training"] = training.dump();
    write_safetensors(path, file, true);
    EXPECT_THROW(run.trainer.load_checkpoint(path), Error) << value;
  }
}

/// Expects that an update fails because a value is not finite, and says which.
void expect_not_finite(NoiseRun& run, const RolloutBatch& batch, const std::string& source = "") {
  testing::expect_error([&] { run.trainer.update(batch); }, source, ExitCode::failed);
}

TEST_F(TrainerTest, NamesTheSourceOfAValueThatIsNotFinite) {
  NoiseRun run(runtime_, true);
  run.train_until(2);
  const auto before = run.weights(folder_ / "before");
  const auto good = run.batch();
  auto batch = good;
  batch.initial_state[3] = std::numeric_limits<float>::infinity();
  expect_not_finite(run, batch, "the initial states are not finite");
  batch = good, batch.target[7] = std::numeric_limits<float>::quiet_NaN();
  expect_not_finite(run, batch, "the labels are not finite");
  batch = good, batch.initial_state.assign(batch.initial_state.size(), 3e38f);
  const std::string kernel =
      runtime_.kernel_variant() == KernelVariant::gpu ? "rollout_gpu" : "rollout";
  expect_not_finite(run, batch, "the output of " + kernel + " is not finite");
  batch = good, batch.target[7] = 3e38f;
  expect_not_finite(run, batch, "the output of state_loss is not finite");
  EXPECT_EQ(run.weights(folder_ / "after"), before);
  EXPECT_EQ(run.trainer.updates(), 2);
  EXPECT_TRUE(std::isfinite(run.trainer.update(good)));
}

TEST_F(TrainerTest, SkipsConsecutiveUpdatesUpToTheMaximum) {
  auto options = NoiseRun::options();
  options.max_consecutive_skips = 2;
  NoiseRun run(runtime_, true, options), other(runtime_, true, options);
  const auto good = run.batch();
  auto bad = good;
  bad.initial_state[3] = 3e38f;
  run.trainer.update(good);
  const auto before = run.weights(folder_ / "before");
  EXPECT_TRUE(std::isnan(run.trainer.update(bad)));
  EXPECT_TRUE(std::isnan(run.trainer.update(bad)));
  EXPECT_EQ(run.weights(folder_ / "after"), before);
  EXPECT_EQ(run.trainer.updates(), 3);
  run.trainer.save_checkpoint(folder_ / "checkpoint");
  expect_not_finite(run, bad);
  run.trainer.update(good);
  EXPECT_TRUE(std::isnan(run.trainer.update(bad))) << "a good update does not reset the count";

  other.trainer.load_checkpoint(folder_ / "checkpoint");
  expect_not_finite(other, bad);
  other.trainer.update(good);
  EXPECT_EQ(other.weights(folder_ / "resumed"), run.weights(folder_ / "whole"));
}

TEST_F(TrainerTest, IgnoresLabelsOfWeightZero) {
  RandomStream random(9, "batch");
  NoiseRun one(runtime_, true), other(runtime_, true);
  auto batch = noise_batch(one.spec, one.sequences, one.steps, one.frames, random);
  batch.weight[5] = 0.0f;
  auto changed = batch;
  for (int i = 0; i < one.spec.state; ++i)
    changed.target[5 * one.spec.state + i] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(one.trainer.update(batch), other.trainer.update(changed));
  EXPECT_EQ(one.weights(folder_ / "one"), other.weights(folder_ / "other"));
  batch.weight.assign(batch.weight.size(), 0.0f);
  EXPECT_THROW(one.trainer.update(batch), Error);
}

/// Expects that a changed batch is rejected.
void expect_rejected(NoiseRun& run, const std::function<void(RolloutBatch&)>& change) {
  auto batch = run.batch();
  change(batch);
  EXPECT_THROW(run.trainer.update(batch), Error);
}

TEST_F(TrainerTest, RejectsInvalidSegments) {
  NoiseRun run(runtime_, small_spec(ObjectEncoder::joint));
  expect_rejected(run, [](RolloutBatch& b) { b.object.clear(); });
  expect_rejected(run, [](RolloutBatch& b) { b.segment_frame.pop_back(); });
  expect_rejected(run, [](RolloutBatch& b) { b.segment_frame[1] = -1; });
  expect_rejected(
      run, [&](RolloutBatch& b) { b.segment_frame[1] = run.frames - run.spec.segment_frames + 1; });
  EXPECT_NO_THROW(run.trainer.update(run.batch()));
}

TEST_F(TrainerTest, RejectsInvalidBatches) {
  NoiseRun run(runtime_, true);
  expect_rejected(run, [&](RolloutBatch& b) { b.first_frame[0] = run.spec.window_frames - 2; });
  expect_rejected(run, [&](RolloutBatch& b) { b.first_frame[0] = run.frames - run.steps + 1; });
  expect_rejected(run, [](RolloutBatch& b) { b.first_frame.pop_back(); });
  expect_rejected(run, [](RolloutBatch& b) { b.target.clear(); });
  expect_rejected(run, [](RolloutBatch& b) { b.sequences = 2; });
  expect_rejected(run, [](RolloutBatch& b) { b.weight.pop_back(); });
  EXPECT_NO_THROW(run.trainer.update(run.batch()));
}

/// Writes a problem for engine_step, which runs in its own process.
void write_problem(const std::filesystem::path& path, const ModelSpec& spec) {
  RandomStream random(6, "problem");
  const auto stream = noise_stream(spec, 60, random);
  const auto batch = noise_batch(spec, 7, 20, 60, random);
  TensorFile file{{{"spec", nlohmann::json(spec).dump()}, {"sequences", "7"}, {"steps", "20"}}, {}};
  const auto add = [&](const char* name, const std::vector<float>& values) {
    file.tensors.push_back({name, {values.size()}, values});
  };
  add("first_frame", {batch.first_frame.begin(), batch.first_frame.end()});
  add("stream", stream);
  add("initial_state", batch.initial_state);
  add("target", batch.target);
  if (spec.object == ObjectEncoder::joint) {
    add("object", {batch.object.begin(), batch.object.end()});
    add("segment_frame", {batch.segment_frame.begin(), batch.segment_frame.end()});
  }
  write_safetensors(path, file, false);
}

TEST_F(TrainerTest, DoesNotDependOnTheNumberOfThreads) {
  write_problem(folder_ / "problem", small_spec(ObjectEncoder::joint));
  const auto trained = [&](const std::string& threads) {
    const auto out = folder_ / ("weights" + threads);
    const auto command = "POCL_MAX_PTHREAD_COUNT=" + threads + " " ENGINE_STEP " " +
                         (folder_ / "problem").string() + " train 50 " + out.string();
    EXPECT_EQ(std::system(command.c_str()), 0);
    return read_file(out);
  };
  const auto one = trained("1");
  EXPECT_EQ(one, trained("2"));
  EXPECT_EQ(one, trained("2")) << "two runs differ";
}

}  // namespace
}  // namespace touchtrace
