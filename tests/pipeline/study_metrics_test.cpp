// Metrics compared with values by hand and with a second, slow implementation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/random.h"
#include "pipeline/study/metrics.h"
#include "pipeline/study/score.h"
#include "tests/support/compare.h"

namespace {

using namespace touchtrace;
using namespace touchtrace::study;
using touchtrace::testing::close;

std::vector<float> random_path(int steps, std::uint64_t seed) {
  RandomStream random(seed, "path");
  std::vector<float> path(static_cast<std::size_t>(steps) * state_size);
  for (float& value : path) value = static_cast<float>(random.normal());
  return path;
}

/// Path with the given first dimension; the others are 0.
std::vector<float> along_x(std::initializer_list<float> x) {
  std::vector<float> path;
  for (float value : x) {
    path.push_back(value);
    path.insert(path.end(), state_size - 1, 0.0f);
  }
  return path;
}

TEST(Metrics, L1IsTheMeanOverTheTwelveDimensions) {
  const auto errors = l1_by_step(along_x({1, 2, 3}), along_x({1, -1, 9}));
  EXPECT_TRUE(close<double>(errors, std::vector<double>{0.0, 3.0 / 12, 6.0 / 12}, 8, 12));
}

TEST(Metrics, HausdorffByHand) {
  EXPECT_DOUBLE_EQ(hausdorff(along_x({0, 1}), along_x({0, 1})), 0.0);
  // The state 5 is 4 away from the nearest of {0, 1}; in the other direction nothing is farther
  // than 1.
  EXPECT_DOUBLE_EQ(hausdorff(along_x({0, 1}), along_x({0, 5})), 4.0);
  EXPECT_DOUBLE_EQ(hausdorff(along_x({0, 5}), along_x({0, 1})), 4.0);
  // The order of the states does not matter: the shape is compared.
  EXPECT_DOUBLE_EQ(hausdorff(along_x({0, 1, 2}), along_x({2, 1, 0})), 0.0);
}

/// All distances first, then rows and columns of the table.
double slow_hausdorff(const std::vector<float>& a, const std::vector<float>& b) {
  const std::size_t n = a.size() / state_size, m = b.size() / state_size;
  std::vector<double> row(n, 1e300), column(m, 1e300);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j) {
      double distance = 0.0;
      for (int d = 0; d < state_size; ++d)
        distance = std::hypot(distance,
                              static_cast<double>(a[i * state_size + d]) - b[j * state_size + d]);
      row[i] = std::min(row[i], distance);
      column[j] = std::min(column[j], distance);
    }
  return std::max(*std::ranges::max_element(row), *std::ranges::max_element(column));
}

TEST(Metrics, HausdorffMatchesASlowImplementation) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto a = random_path(50, 2 * seed), b = random_path(50, 2 * seed + 1);
    const double expected = slow_hausdorff(a, b), actual = hausdorff(a, b);
    EXPECT_TRUE(close<double>(std::span(&actual, 1), std::span(&expected, 1), 8, state_size));
  }
}

TEST(Metrics, DistanceIsThatOfOneBody) {
  auto predicted = random_path(3, 1), target = predicted;
  target[6] += 3.0f;
  target[7] += 4.0f;
  const auto hand = distance_by_step(predicted, target, hand_position),
             object = distance_by_step(predicted, target, object_position);
  EXPECT_NEAR(hand[0], 5.0, 1e-6);
  EXPECT_EQ(hand[1], 0.0);
  EXPECT_EQ(object[0], 0.0);
}

TEST(Metrics, MeanUntilStopsAtItsStepAndIgnoresZeroWeights) {
  const std::vector<double> values{1, 2, 100, 1000};
  const std::vector<float> weight{1, 1, 0, 1};
  EXPECT_DOUBLE_EQ(mean_until(values, weight, 2), 1.5);
  EXPECT_DOUBLE_EQ(mean_until(values, weight, 3), 1.5);
  EXPECT_DOUBLE_EQ(mean_until(values, weight, 4), 1003.0 / 3);
  EXPECT_TRUE(std::isnan(mean_until(values, std::vector<float>(4, 0.0f), 4)));
}

RolloutCases cases_of(std::vector<float> target, int count, int steps) {
  RolloutCases cases;
  cases.batch.sequences = count;
  cases.batch.steps = steps;
  cases.batch.target = std::move(target);
  cases.batch.weight.assign(static_cast<std::size_t>(count * steps), 1.0f);
  for (int i = 0; i < count; ++i) cases.sequence.push_back(i / 2);
  return cases;
}

Normalization metres_times(float sigma) {
  Normalization scaling;
  scaling.sigma.fill(sigma);
  return scaling;
}

TEST(Score, MetresAreIndependentOfTheScaling) {
  auto target = random_path(50, 5), predicted = target;
  for (std::size_t i = 0; i < predicted.size(); i += state_size) predicted[i] += 0.5f;
  const auto scores = score(predicted, cases_of(target, 1, 50), metres_times(0.1f));
  EXPECT_NEAR(scores[0].l1_at_50, 0.5 / 12, 1e-6);
  EXPECT_NEAR(scores[0].object.m_at_20, 0.05, 1e-6);
  EXPECT_NEAR(scores[0].hand.m_at_50, 0.0, 1e-6);
}

TEST(Score, RejectsNonFiniteValues) {
  auto target = random_path(50, 5), predicted = target;
  predicted[77] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(score(predicted, cases_of(target, 1, 50), metres_times(1.0f)), std::runtime_error);
}

TEST(Score, PositionsAndVelocitiesOfBothBodiesApart) {
  auto target = random_path(50, 5), predicted = target;
  for (std::size_t i = 0; i < predicted.size(); i += state_size) {
    predicted[i + 4] += 3.0f;
    predicted[i + 11] -= 4.0f;
  }
  const auto score_of = score(predicted, cases_of(target, 1, 50), metres_times(0.1f))[0];
  EXPECT_NEAR(score_of.object.m_per_s_at_20, 0.3, 1e-6);
  EXPECT_NEAR(score_of.hand.m_per_s_at_50, 0.4, 1e-6);
  EXPECT_NEAR(score_of.object.m_at_50 + score_of.hand.m_at_50, 0.0, 1e-6);
  EXPECT_NEAR(score_of.object.hausdorff_m, 0.0, 1e-6);
  EXPECT_GT(score_of.hausdorff, 0.0);
}

TEST(Score, NoMetricDependsOnStepsOfWeightZero) {
  auto cases = cases_of(random_path(50, 5), 1, 50);
  cases.batch.weight[7] = cases.batch.weight[31] = 0.0f;
  const auto predicted = random_path(50, 6);
  const auto before = score(predicted, cases, metres_times(0.1f))[0];
  for (std::size_t step : {7u, 31u})
    for (std::size_t d = 0; d < state_size; ++d) cases.batch.target[step * state_size + d] = 1e4f;
  const auto after = score(predicted, cases, metres_times(0.1f))[0];
  for (const Metric& metric : all_metrics())
    EXPECT_EQ(metric.value(before), metric.value(after)) << metric.name;
  EXPECT_TRUE(std::isnan(mean_curve({after}, {0})[7]));
  EXPECT_EQ(mean_curve({before, after}, {0, 1})[8], before.l1_by_step[8]);
}

}  // namespace
