#include "engine/train/trainer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/train/noise_batch.h"
#include "engine/train/safetensors.h"
#include "tests/engine/small_spec.h"

namespace touchtrace {
namespace {

using testing::small_spec;

class TrainerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("trainer_" + std::to_string(getpid()) +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  Runtime runtime_{choose_device("")};
};

/// A point on a line pushed by an acceleration that the touched taxels carry: a bright column at
/// its value. The state is position and velocity; nothing but touch tells where it will be pushed.
struct PushedPoint {
  static constexpr int frames = 3000, rows = 8, cols = 8;

  PushedPoint() : tactile(std::size_t(frames) * rows * cols) {
    RandomStream random(11, "pushed point");
    double push = 0.0, position = 0.0, velocity = 0.0;
    for (int f = 0; f < frames; ++f) {
      states.push_back({float(position), float(velocity)});
      push = 0.8 * push + 0.6 * random.normal();
      for (int i = 0; i < rows * cols; ++i)
        tactile[std::size_t(f) * rows * cols + i] =
            float(std::exp(-0.5 * std::pow(i % cols - 3.5 - push, 2)));
      velocity = 0.8 * velocity + 0.3 * push;
      position = 0.9 * position + 0.3 * velocity;
    }
  }

  ModelSpec spec(bool touch) const {
    return {.touch = touch,
            .window_frames = 2,
            .rows = rows,
            .cols = cols,
            .embedding = 16,
            .hidden = 64,
            .state = 2};
  }

  RolloutBatch batch(int sequences, int steps, RandomStream& random) const {
    RolloutBatch result;
    result.sequences = sequences, result.steps = steps;
    for (int s = 0; s < sequences; ++s) {
      const int first = 1 + int(random.below(frames - steps - 1));
      result.first_frame.push_back(first);
      result.initial_state.insert(result.initial_state.end(), states[first].begin(),
                                  states[first].end());
      for (int k = 1; k <= steps; ++k)
        result.target.insert(result.target.end(), states[first + k].begin(),
                             states[first + k].end());
    }
    return result;
  }

  std::vector<float> tactile;
  std::vector<std::array<float, 2>> states;
};

/// Mean loss of the last fifth of the updates.
double train(Trainer& trainer, const PushedPoint& task, int updates) {
  RandomStream random(2, "batches");
  double loss = 0.0;
  for (int u = 0; u < updates; ++u) {
    const double now = trainer.update(task.batch(8, 10, random));
    if (u >= updates * 4 / 5) loss += now / (updates - updates * 4 / 5);
  }
  return loss;
}

double mean_error(const Rollout& rollout, const std::vector<float>& target) {
  double sum = 0.0;
  for (std::size_t i = 0; i < target.size(); ++i) sum += std::abs(rollout.state[i] - target[i]);
  return sum / double(target.size());
}

TEST_F(TrainerTest, LearnsWhatOnlyTouchTells) {
  const PushedPoint task;
  RandomStream random(4, "unseen");
  const auto batch = task.batch(40, 25, random);
  TrainOptions options;
  options.updates = 400;
  double loss[2], error[2];
  for (bool touch : {false, true}) {
    Trainer trainer(runtime_, task.spec(touch), options, 8, 10,
                    touch ? std::span<const float>(task.tactile) : std::span<const float>());
    loss[touch] = train(trainer, task, options.updates);
    const auto model = folder_ / (touch ? "touch" : "none");
    trainer.save(model, {{"task", "pushed point"}}, false);
    Predictor predictor(runtime_, model);
    EXPECT_EQ(predictor.metadata(), (nlohmann::json{{"task", "pushed point"}}));
    EXPECT_EQ(predictor.spec().touch, touch);
    error[touch] = mean_error(predictor.predict(batch, touch ? std::span<const float>(task.tactile)
                                                             : std::span<const float>()),
                              batch.target);
  }
  EXPECT_LT(loss[1], 0.5 * loss[0]);
  EXPECT_LT(error[1], 0.5 * error[0]);
}

TEST_F(TrainerTest, BandsHoldTheirShareOfWhatHappens) {
  const PushedPoint task;
  TrainOptions options;
  options.updates = 400;
  Trainer trainer(runtime_, task.spec(false), options, 8, 10, {});
  train(trainer, task, options.updates);
  trainer.save(folder_ / "model", {}, false);
  RandomStream random(5, "unseen");
  const auto batch = task.batch(100, 10, random);
  const auto rollout = Predictor(runtime_, folder_ / "model").predict(batch, {});
  int inside = 0;
  for (std::size_t i = 0; i < batch.target.size(); ++i)
    inside += std::abs(batch.target[i] - rollout.state[i]) <= rollout.spread[i];
  const double share = inside / double(batch.target.size());
  EXPECT_GT(share, 0.65);
  EXPECT_LT(share, 0.92);
}

/// A trainer on noise, with everything that a resumed run must restore in play.
struct NoiseRun {
  static constexpr int sequences = 3, steps = 4, frames = 40;

  NoiseRun(Runtime& runtime, bool touch)
      : spec(small_spec(touch)),
        trainer(runtime, spec, options(), sequences, steps, stream(spec)) {}

  static TrainOptions options() {
    TrainOptions o;
    o.updates = 12;
    return o;
  }
  static std::vector<float> stream(const ModelSpec& spec) {
    RandomStream random(1, "stream");
    return noise_stream(spec, frames, random);
  }
  void go_on_to(int update) {
    while (trainer.updates() < update) {
      RandomStream random(trainer.updates(), "batch");
      trainer.update(noise_batch(spec, sequences, steps, frames, random));
    }
  }
  std::string weights(const std::filesystem::path& path) {
    trainer.save(path, {}, true);
    return read_file(path);
  }

  ModelSpec spec;
  Trainer trainer;
};

TEST_F(TrainerTest, ResumesBitIdentically) {
  for (bool touch : {false, true}) {
    NoiseRun whole(runtime_, touch);
    whole.go_on_to(10);
    for (int stop : {1, 7}) {
      NoiseRun killed(runtime_, touch);
      killed.go_on_to(stop);
      killed.trainer.save_checkpoint(folder_ / "checkpoint");
      NoiseRun resumed(runtime_, touch);
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

TEST_F(TrainerTest, StopsAtAValueThatIsNotFinite) {
  NoiseRun run(runtime_, false);
  run.go_on_to(2);
  const auto before = run.weights(folder_ / "before");
  RandomStream random(9, "batch");
  auto batch = noise_batch(run.spec, run.sequences, run.steps, run.frames, random);
  batch.initial_state[3] = std::numeric_limits<float>::infinity();
  try {
    run.trainer.update(batch);
    FAIL() << "trained on an infinite state";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::failed);
    EXPECT_NE(std::string(error.what()).find("the roll-out's states"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(run.weights(folder_ / "after"), before);
  EXPECT_EQ(run.trainer.updates(), 2);
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
  write_safetensors(path, file, false);
}

TEST_F(TrainerTest, ThreadsDoNotChangeABit) {
  write_problem(folder_ / "problem", small_spec(true));
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

class PredictorTest : public TrainerTest {
 protected:
  std::filesystem::path model(bool touch) {
    NoiseRun run(runtime_, touch);
    run.go_on_to(3);
    run.trainer.save(folder_ / "model", {}, true);
    return folder_ / "model";
  }
};

void expect_finite(const Rollout& rollout) {
  for (float value : rollout.state) ASSERT_TRUE(std::isfinite(value));
  for (float value : rollout.spread) {
    ASSERT_TRUE(std::isfinite(value));
    ASSERT_GE(value, 0.0f);
  }
}

TEST_F(PredictorTest, TakesAnyNumberOfSequencesAndSteps) {
  const auto spec = small_spec(true);
  RandomStream random(3, "stream");
  const auto stream = noise_stream(spec, 520, random);
  Predictor predictor(runtime_, model(true));
  for (const auto& [sequences, steps] : {std::pair{1, 1}, {1, 500}, {3, 21}, {70, 45}, {32, 20}}) {
    const auto batch = noise_batch(spec, sequences, steps, 520, random);
    const auto rollout = predictor.predict(batch, stream);
    EXPECT_EQ(rollout.state.size(), std::size_t(sequences) * steps * spec.state);
    expect_finite(rollout);
  }
  EXPECT_TRUE(predictor.predict({}, stream).state.empty());
}

TEST_F(PredictorTest, BlocksDoNotShow) {
  const auto spec = small_spec(true);
  RandomStream random(3, "stream");
  const auto stream = noise_stream(spec, 200, random);
  Predictor predictor(runtime_, model(true));
  const int steps = 47;
  const auto batch = noise_batch(spec, 70, steps, 200, random);
  const auto together = predictor.predict(batch, stream);
  for (int s : {0, 31, 32, 69}) {
    RolloutBatch alone;
    alone.sequences = 1, alone.steps = steps, alone.first_frame = {batch.first_frame[s]};
    const auto* initial = &batch.initial_state[std::size_t(s) * spec.state];
    alone.initial_state.assign(initial, initial + spec.state);
    const auto rollout = predictor.predict(alone, stream);
    const auto at = std::ptrdiff_t(s) * steps * spec.state;
    EXPECT_TRUE(
        std::equal(rollout.state.begin(), rollout.state.end(), together.state.begin() + at));
    EXPECT_TRUE(
        std::equal(rollout.spread.begin(), rollout.spread.end(), together.spread.begin() + at));
  }
}

TEST_F(PredictorTest, NeedsNoStreamWithoutTouch) {
  RandomStream random(3, "batch");
  auto batch = noise_batch(small_spec(false), 4, 30, 100, random);
  batch.first_frame.clear();
  expect_finite(Predictor(runtime_, model(false)).predict(batch, {}));
}

TEST_F(PredictorTest, RefusesWindowsOutsideTheStream) {
  const auto spec = small_spec(true);
  RandomStream random(3, "stream");
  const auto stream = noise_stream(spec, 30, random);
  Predictor predictor(runtime_, model(true));
  auto batch = noise_batch(spec, 2, 10, 30, random);
  batch.first_frame[1] = 21;
  EXPECT_THROW(predictor.predict(batch, stream), Error);
  EXPECT_THROW(predictor.predict(batch, {}), Error);
}

TEST_F(PredictorTest, RefusesFilesThatAreNoModel) {
  write_safetensors(folder_ / "empty", {}, false);
  EXPECT_THROW(Predictor(runtime_, folder_ / "empty"), Error);
  auto file = read_safetensors(model(true));
  const auto spec = file.metadata["spec"];
  for (const std::string bad : {"", "7", "{", "{}", R"({"touch":3})"}) {
    file.metadata["spec"] = bad;
    write_safetensors(folder_ / "bad", file, true);
    EXPECT_THROW(Predictor(runtime_, folder_ / "bad"), Error) << bad;
  }
  file.metadata["spec"] = spec;
  file.tensors.pop_back();
  write_safetensors(folder_ / "bad", file, true);
  EXPECT_THROW(Predictor(runtime_, folder_ / "bad"), Error);
}

}  // namespace
}  // namespace touchtrace
