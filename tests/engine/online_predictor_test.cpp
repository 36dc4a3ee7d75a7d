#include "engine/train/online_predictor.h"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "engine/base/error.h"
#include "engine/train/safetensors.h"
#include "tests/engine/trainer_fixture.h"

namespace touchtrace {
namespace {

using testing::NoiseRun;
using testing::small_spec;
using testing::with_gru;

/// A briefly trained model and a roll-out that starts at frame `first` of a stream.
class OnlinePredictorTest : public testing::TrainerTest {
 protected:
  static constexpr int first = 5, steps = 40;

  void prepare(bool touch) { prepare(small_spec(touch)); }
  void prepare(const ModelSpec& spec) {
    NoiseRun run(runtime_, spec);
    run.train_until(3);
    run.trainer.save(model_, {{"made", "here"}}, true);
    batch_.sequences = 1, batch_.steps = steps, batch_.first_frame = {first};
    RandomStream random(3, "roll-out");
    batch_.initial_state = normal_floats(run.spec.state, random);
    stream_ = noise_stream(run.spec, first + steps, random);
    if (!spec.touch) stream_.clear();
  }

  std::span<const float> frame(int f) const {
    const std::size_t size = stream_.size() / (first + steps);
    return std::span(stream_).subspan(f * size, size);
  }

  /// Rolls out step by step.
  Rollout follow(OnlinePredictor& online) const {
    Rollout rollout;
    for (int f = 0; f < first; ++f) online.push(frame(f));
    online.set_state(batch_.initial_state);
    for (int f = first; f < first + steps; ++f) {
      const auto [state, spread] = online.step(frame(f));
      rollout.state.insert(rollout.state.end(), state.begin(), state.end());
      rollout.spread.insert(rollout.spread.end(), spread.begin(), spread.end());
    }
    return rollout;
  }

  std::filesystem::path model_ = folder_ / "model";
  RolloutBatch batch_;
  std::vector<float> stream_;
};

TEST_F(OnlinePredictorTest, MatchesARolloutBitwise) {
  for (const auto& spec : {small_spec(true), small_spec(false), with_gru(small_spec(true))}) {
    prepare(spec);
    const auto expected = Predictor(runtime_, model_).predict(batch_, stream_);
    OnlinePredictor online(runtime_, model_);
    EXPECT_EQ(online.metadata(), (nlohmann::json{{"made", "here"}}));
    for (int repetition = 0; repetition < 2; ++repetition) {
      const auto rollout = follow(online);
      EXPECT_EQ(rollout.state, expected.state);
      EXPECT_EQ(rollout.spread, expected.spread);
    }
  }
}

TEST_F(OnlinePredictorTest, FramesBeforeTheFirstAreZero) {
  prepare(true);
  const auto spec = small_spec(true);
  const std::size_t size = frame(0).size();
  const auto windows_first = spec.window_frames - 1;
  std::vector<float> padded(windows_first * size, 0.0f);
  padded.insert(padded.end(), frame(0).begin(), frame(0).end());
  batch_.steps = 1, batch_.first_frame = {windows_first};
  const auto expected = Predictor(runtime_, model_).predict(batch_, padded);
  OnlinePredictor online(runtime_, model_);
  online.set_state(batch_.initial_state);
  const auto [state, spread] = online.step(frame(0));
  EXPECT_TRUE(std::ranges::equal(state, expected.state));
  EXPECT_TRUE(std::ranges::equal(spread, expected.spread));
}

// In a separate process, since PoCL chooses its devices at the first use of OpenCL.
TEST_F(OnlinePredictorTest, MatchesARolloutOnTheDeviceForSmallSteps) {
  prepare(true);
  batch_.steps = 1;
  const auto expected = Predictor(runtime_, model_).predict(batch_, stream_);
  auto problem = read_safetensors(model_);
  problem.metadata.insert({{"sequences", "1"}, {"steps", "1"}});
  problem.tensors.push_back({"stream", {stream_.size()}, stream_});
  problem.tensors.push_back({"first_frame", {1}, {float(first)}});
  problem.tensors.push_back({"initial_state", {batch_.initial_state.size()}, batch_.initial_state});
  write_safetensors(folder_ / "problem", problem, false);
  const auto out = (folder_ / "out").string();
  const auto command =
      "echo 9 | " ENGINE_STEP " " + (folder_ / "problem").string() + " online | tail -n 1 >" + out;
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::istringstream line(read_file(out));
  for (const auto* values : {&expected.state, &expected.spread})
    for (const float value : *values) {
      std::string word;
      line >> word;
      EXPECT_EQ(std::strtof(word.c_str(), nullptr), value) << word;
    }
}

TEST_F(OnlinePredictorTest, RejectsInvalidSizes) {
  prepare(true);
  OnlinePredictor online(runtime_, model_);
  EXPECT_THROW(online.set_state(std::vector<float>(4)), Error);
  EXPECT_THROW(online.push({}), Error);
  EXPECT_THROW(online.step(std::vector<float>(frame(0).size() + 1)), Error);
}

// Fault injection: the queue is blocked, so that the write of the window stays pending, and the
// first launch fails.
TEST_F(OnlinePredictorTest, ThrowsOnlyAfterPendingWritesAreDone) {
  prepare(true);
  OnlinePredictor online(runtime_, model_);
  online.set_state(batch_.initial_state);
  online.step(frame(0));
  cl::UserEvent gate(runtime_.context());
  const std::vector<cl::Event> wait{gate};
  runtime_.queue().enqueueBarrierWithWaitList(&wait);
  runtime_.set_launch_observer([](const Launch&) { throw failure("injected", ""); });
  std::atomic<bool> opened = false;
  std::thread opener([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    opened = true;
    gate.setStatus(CL_COMPLETE);
  });
  EXPECT_THROW(online.step(frame(1)), Error);
  EXPECT_TRUE(opened) << "the predictor's window may still be read";
  opener.join();
  runtime_.set_launch_observer({});
  runtime_.finish();
}

}  // namespace
}  // namespace touchtrace
