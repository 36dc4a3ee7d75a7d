#include "engine/train/trainer.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "engine/base/error.h"
#include "engine/train/safetensors.h"
#include "tests/engine/trainer_fixture.h"

namespace touchtrace {
namespace {

using testing::NoiseRun;
using testing::small_spec;
using testing::TrainerTest;

TEST_F(TrainerTest, ResumesBitIdentically) {
  Runtime exact(choose_device(""), Accuracy::exact);
  for (auto* runtime : {&runtime_, &exact})
    for (const auto& spec : {small_spec(false), small_spec(true), small_spec(ObjectEncoder::joint),
                             testing::with_gru(small_spec(true))}) {
      NoiseRun whole(*runtime, spec);
      whole.go_on_to(10);
      for (int stop : {1, 7}) {
        NoiseRun killed(*runtime, spec);
        killed.go_on_to(stop);
        killed.trainer.save_checkpoint(folder_ / "checkpoint", {{"clips", 7}});
        EXPECT_EQ(Trainer::checkpoint_notes(folder_ / "checkpoint").at("clips"), 7);
        NoiseRun resumed(*runtime, spec);
        resumed.go_on_to(3);
        resumed.trainer.load_checkpoint(folder_ / "checkpoint");
        EXPECT_EQ(resumed.trainer.updates(), stop);
        resumed.go_on_to(10);
        EXPECT_EQ(resumed.weights(folder_ / "a"), whole.weights(folder_ / "b"));
      }
    }
}

TEST_F(TrainerTest, RefusesAForeignCheckpoint) {
  NoiseRun run(runtime_, false), other(runtime_, true);
  run.go_on_to(1);
  const auto before = run.weights(folder_ / "before");
  EXPECT_THROW(run.trainer.load_checkpoint(folder_ / "before"), Error) << "a model without moments";
  other.trainer.save_checkpoint(folder_ / "checkpoint");
  EXPECT_THROW(run.trainer.load_checkpoint(folder_ / "checkpoint"), Error) << "another model's";
  EXPECT_THROW(run.trainer.load_checkpoint(folder_ / "missing"), Error);
  EXPECT_EQ(run.weights(folder_ / "after"), before);
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// What an update on `batch` says is not finite.
std::string refusal(NoiseRun& run, const RolloutBatch& batch) {
  try {
    run.trainer.update(batch);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::failed);
    return error.what();
  }
  ADD_FAILURE() << "trained on what is not finite";
  return {};
}

TEST_F(TrainerTest, StopsAtAValueThatIsNotFiniteAndNamesWhatMadeIt) {
  NoiseRun run(runtime_, true);
  run.go_on_to(2);
  const auto before = run.weights(folder_ / "before");
  const auto good = run.batch();
  auto batch = good;
  batch.initial_state[3] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(says(refusal(run, batch), "the initial states are not finite"));
  batch = good, batch.target[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(says(refusal(run, batch), "the labels are not finite"));
  batch = good, batch.initial_state.assign(batch.initial_state.size(), 3e38f);
  EXPECT_TRUE(says(refusal(run, batch), "what rollout computes is not finite"));
  batch = good, batch.target[7] = 3e38f;
  EXPECT_TRUE(says(refusal(run, batch), "what state_loss computes is not finite"));
  EXPECT_EQ(run.weights(folder_ / "after"), before);
  EXPECT_EQ(run.trainer.updates(), 2);
  EXPECT_TRUE(std::isfinite(run.trainer.update(good)));
}

TEST_F(TrainerTest, LeavesOutSomeUpdatesInARowIfAskedTo) {
  auto options = NoiseRun::options();
  options.skips_in_a_row = 2;
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
  refusal(run, bad);
  run.trainer.update(good);
  EXPECT_TRUE(std::isnan(run.trainer.update(bad))) << "a good update does not start the count anew";

  other.trainer.load_checkpoint(folder_ / "checkpoint");
  refusal(other, bad);
  other.trainer.update(good);
  EXPECT_EQ(other.weights(folder_ / "resumed"), run.weights(folder_ / "whole"));
}

TEST_F(TrainerTest, LabelsOfWeightZeroCountNothing) {
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

TEST_F(TrainerTest, RefusesSegmentsThatDoNotFit) {
  NoiseRun run(runtime_, small_spec(ObjectEncoder::joint));
  RandomStream random(9, "batch");
  const auto good = noise_batch(run.spec, run.sequences, run.steps, run.frames, random);
  const auto refused = [&](auto change) {
    auto batch = good;
    change(batch);
    EXPECT_THROW(run.trainer.update(batch), Error);
  };
  refused([](RolloutBatch& b) { b.object.clear(); });
  refused([](RolloutBatch& b) { b.segment_frame.pop_back(); });
  refused([](RolloutBatch& b) { b.segment_frame[1] = -1; });
  refused([&](RolloutBatch& b) { b.segment_frame[1] = run.frames - run.spec.segment_frames + 1; });
  EXPECT_NO_THROW(run.trainer.update(good));
}

TEST_F(TrainerTest, RefusesBatchesThatDoNotFit) {
  NoiseRun run(runtime_, true);
  RandomStream random(9, "batch");
  const auto good = noise_batch(run.spec, run.sequences, run.steps, run.frames, random);
  const auto refused = [&](auto change) {
    auto batch = good;
    change(batch);
    EXPECT_THROW(run.trainer.update(batch), Error);
  };
  refused([&](RolloutBatch& b) { b.first_frame[0] = run.spec.window_frames - 2; });
  refused([&](RolloutBatch& b) { b.first_frame[0] = run.frames - run.steps + 1; });
  refused([](RolloutBatch& b) { b.first_frame.pop_back(); });
  refused([](RolloutBatch& b) { b.target.clear(); });
  refused([](RolloutBatch& b) { b.sequences = 2; });
  refused([](RolloutBatch& b) { b.weight.pop_back(); });
  EXPECT_NO_THROW(run.trainer.update(good));
}

/// A problem for engine_step, which runs in a process of its own.
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

TEST_F(TrainerTest, ThreadsDoNotChangeABit) {
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
