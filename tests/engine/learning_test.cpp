#include <cmath>
#include <numeric>

#include "tests/engine/trainer_fixture.h"

namespace touchtrace {
namespace {

using testing::small_spec;
using testing::TrainerTest;

/// A point on a line with a random acceleration. The state is position and velocity; only the
/// tactile frame shows the acceleration, as the position of a bright column.
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

/// Trains and returns the mean loss of the last fifth of the updates.
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

TEST_F(TrainerTest, UsesTouch) {
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

TEST_F(TrainerTest, CalibratesBands) {
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
  // The exact band, 1.28 standard deviations of the state given the initial one, covers 0.802 of
  // such batches with a standard deviation of 0.031 (400 simulated paths); the bound is 3 of these.
  // Bands of one and of two standard deviations cover 0.68 and 0.95.
  EXPECT_NEAR(inside / double(batch.target.size()), 0.8, 0.093);
}

}  // namespace
}  // namespace touchtrace
