// Baselines compared with values by hand, and bootstrap intervals with their theory.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "pipeline/study/baselines.h"
#include "pipeline/study/bootstrap.h"
#include "pipeline/study/metrics.h"

namespace {

using namespace touchtrace;
using namespace touchtrace::study;

constexpr double step_s = 0.1;

Normalization identity() {
  Normalization scaling;
  scaling.sigma.fill(1.0f);
  return scaling;
}

/// Cases of random initial states, two of each clip; each step's target is `next` of the state
/// before.
template <class Next>
RolloutCases cases_of(int count, int steps, std::uint64_t seed, Next next) {
  RandomStream random(seed, "states");
  RolloutCases cases;
  cases.batch.sequences = count;
  cases.batch.steps = steps;
  cases.batch.weight.assign(static_cast<std::size_t>(count * steps), 1.0f);
  for (int i = 0; i < count; ++i) {
    State state;
    for (float& value : state) value = static_cast<float>(random.normal());
    cases.sequence.push_back(i / 2);
    cases.batch.initial_state.insert(cases.batch.initial_state.end(), state.begin(), state.end());
    for (int step = 0; step < steps; ++step) {
      state = next(state);
      cases.batch.target.insert(cases.batch.target.end(), state.begin(), state.end());
    }
  }
  return cases;
}

State damped(State state) {
  for (int d : {3, 4, 5, 9, 10, 11}) {
    state[d] *= 0.7f;
    state[d - 3] += static_cast<float>(step_s) * state[d];
  }
  return state;
}

State rotated(State state) {
  for (int d = 0; d < state_size; d += 2)
    std::tie(state[d], state[d + 1]) =
        std::pair(0.8f * state[d] - 0.6f * state[d + 1], 0.6f * state[d] + 0.8f * state[d + 1] + 1);
  return state;
}

std::vector<float> paths_of(const std::vector<Baseline>& baselines, const char* name) {
  const auto found = std::ranges::find(baselines, name, &Baseline::name);
  return found == baselines.end() ? std::vector<float>{} : found->paths;
}

double largest_error(const std::vector<float>& paths, const RolloutCases& cases) {
  double largest = paths.size() == cases.batch.target.size() ? 0.0 : NAN;
  for (std::size_t i = 0; i < paths.size(); ++i)
    largest = std::max(largest, std::abs(static_cast<double>(paths[i]) - cases.batch.target[i]));
  return largest;
}

TEST(Baselines, HoldKeepsThePositionAndStops) {
  Normalization scaling = identity();
  scaling.mean[3] = 2.0f, scaling.sigma[3] = 4.0f;
  const auto cases = cases_of(2, 3, 1, damped);
  const auto hold = paths_of(make_baselines(cases, {}, scaling, step_s, 1), "hold");
  ASSERT_EQ(hold.size(), cases.batch.target.size());
  for (std::size_t step = 0; step < 3; ++step) {
    EXPECT_FLOAT_EQ(hold[step * state_size], cases.batch.initial_state[0]);
    EXPECT_FLOAT_EQ(hold[step * state_size + 3], -0.5f) << "velocity 0, normalised";
  }
}

TEST(Baselines, FittedOnesRecoverTheirModel) {
  const auto damped_training = cases_of(40, 5, 1, damped), damped_cases = cases_of(6, 5, 2, damped);
  EXPECT_LT(
      largest_error(
          paths_of(make_baselines(damped_cases, damped_training, identity(), step_s, 1), "damped"),
          damped_cases),
      1e-5);
  const auto training = cases_of(400, 5, 1, rotated), cases = cases_of(6, 5, 2, rotated);
  // The ridge shrinks coefficients by its ratio to the variance of the states, 1e-3; states are up
  // to 4.
  EXPECT_LT(largest_error(
                paths_of(make_baselines(cases, training, identity(), step_s, 1), "linear"), cases),
            0.02);
}

TEST(Baselines, IgnoreUntrustedTrainingSteps) {
  auto training = cases_of(200, 5, 1, rotated);
  const auto cases = cases_of(6, 5, 2, rotated);
  for (std::size_t i = 0; i < training.batch.weight.size(); i += 10) {
    training.batch.weight[i] = 0.0f;
    std::fill_n(&training.batch.target[i * state_size], state_size, 1e6f);
  }
  const auto baselines = make_baselines(cases, training, identity(), step_s, 1);
  EXPECT_LT(largest_error(paths_of(baselines, "linear"), cases), 0.02);
  for (float value : paths_of(baselines, "median")) EXPECT_LT(std::abs(value), 10.0f);
}

TEST(Baselines, RandomIsAPathOfAnotherClipWithItsWeights) {
  auto cases = cases_of(20, 3, 9, damped);
  for (std::size_t i = 0; i < cases.batch.weight.size(); i += 7) cases.batch.weight[i] = 0.0f;
  const auto random = make_baselines(cases, {}, identity(), step_s, 4)[0];
  EXPECT_EQ(random.paths, make_baselines(cases, {}, identity(), step_s, 4)[0].paths);
  EXPECT_NE(random.paths, make_baselines(cases, {}, identity(), step_s, 5)[0].paths);
  const std::size_t size = cases.path_size();
  const auto is_copy = [&](std::size_t i, std::size_t j) {
    return std::equal(&random.paths[i * size], &random.paths[i * size] + size,
                      &cases.batch.target[j * size]);
  };
  for (std::size_t i = 0; i < 20; ++i) {
    std::size_t j = 0;
    while (j < 20 && !is_copy(i, j)) ++j;
    ASSERT_LT(j, 20u);
    EXPECT_NE(cases.sequence[j], cases.sequence[i]);
    for (std::size_t step = 0; step < 3; ++step)
      EXPECT_EQ(random.weight[i * 3 + step], cases.batch.weight[j * 3 + step]);
  }
}

/// Normal values for `clips` clips of `copies` equal roll-outs.
std::vector<double> clip_values(int clips, int copies, double mean, std::uint64_t seed) {
  RandomStream random(seed, "clips");
  std::vector<double> values;
  for (int c = 0; c < clips; ++c)
    values.insert(values.end(), static_cast<std::size_t>(copies), mean + random.normal());
  return values;
}

std::vector<int> clips_of(int clips, int copies) {
  std::vector<int> clip;
  for (int i = 0; i < clips * copies; ++i) clip.push_back(i / copies);
  return clip;
}

// 2000 samples estimate a quantile to some 5 %, the variance of n clips is known to sqrt(2 / n):
// 7 % of the standard error for 100; 0.25 is three times their sum in quadrature.
TEST(Bootstrap, IntervalIsThatOfClipsNotOfRollouts) {
  for (int copies : {1, 50}) {
    const Interval found =
        bootstrap_mean({clip_values(100, copies, 1.0, 3)}, clips_of(100, copies), 1);
    EXPECT_NEAR((found.high - found.low) / (2 * 1.96 / 10), 1.0, 0.25);
    EXPECT_LT(found.low, found.mean);
    EXPECT_GT(found.high, found.mean);
  }
}

/// Of 600 means of three normal values, 95 % should be within their intervals: standard error 0.9
/// %. Without the factor of Student's t it is 72 %.
TEST(Bootstrap, IntervalsOfFewClipsAreWideEnough) {
  int covered = 0;
  for (std::uint64_t trial = 0; trial < 600; ++trial) {
    const Interval found =
        bootstrap_mean({clip_values(3, 1, 0.0, 100 + trial)}, clips_of(3, 1), trial);
    covered += found.low < 0.0 && found.high > 0.0;
  }
  EXPECT_NEAR(covered / 600.0, 0.95, 0.03);
}

TEST(Bootstrap, IntervalOfTwoClipsIsStudents) {
  const Interval found = bootstrap_mean({{0.0, 1.0}}, {0, 1}, 1);
  constexpr double half_width = 12.706 * 0.5;  // the standard error of the mean is 0.5
  EXPECT_NEAR(found.low, 0.5 - half_width, 1e-9);
  EXPECT_NEAR(found.high, 0.5 + half_width, 1e-9);
}

TEST(Bootstrap, SeedsThatDisagreeWidenTheInterval) {
  const RunValues agree{clip_values(100, 1, 0, 1), clip_values(100, 1, 0, 1)},
      differ{clip_values(100, 1, 0, 1), clip_values(100, 1, 2, 1)};
  const auto clip = clips_of(100, 1);
  const Interval narrow = bootstrap_mean(agree, clip, 1), wide = bootstrap_mean(differ, clip, 1);
  EXPECT_NEAR(wide.mean - narrow.mean, 1.0, 1e-9);
  // Both seeds drawn alike in half of the samples: means 1 below and above.
  EXPECT_GT(wide.high - wide.low, 2.0);
  EXPECT_LT(narrow.high - narrow.low, 0.6);
}

TEST(Bootstrap, DifferencesOnSharedClipsAreNarrow) {
  const RunValues a{clip_values(20, 3, 1.5, 1)}, b{clip_values(20, 3, 1.0, 1)};
  const Interval found = bootstrap_difference(a, b, clips_of(20, 3), 1);
  EXPECT_NEAR(found.mean, 0.5, 1e-9);
  EXPECT_NEAR(found.high - found.low, 0.0, 1e-9);
}

TEST(Bootstrap, OneClipHasNoIntervalAndUndefinedRolloutsAreLeftOut) {
  const Interval one = bootstrap_mean({{1.0, 2.0, NAN}}, {0, 0, 0}, 1);
  EXPECT_DOUBLE_EQ(one.mean, 1.5);
  EXPECT_TRUE(std::isnan(one.low) && std::isnan(one.high));
  EXPECT_TRUE(std::isnan(bootstrap_mean({{NAN}}, {0}, 1).mean));
  EXPECT_DOUBLE_EQ(bootstrap_difference({{1.0, 9.0}}, {{0.5, NAN}}, {0, 1}, 1).mean, 0.5);
}

}  // namespace
