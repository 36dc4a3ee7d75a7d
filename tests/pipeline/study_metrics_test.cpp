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
  const auto hand = distance_by_step(predicted, target, 6),
             object = distance_by_step(predicted, target, 0);
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
  EXPECT_NEAR(scores[0].object_m_at_20, 0.05, 1e-6);
  EXPECT_NEAR(scores[0].hand_m_at_50, 0.0, 1e-6);
}

TEST(Score, RejectsNonFiniteValues) {
  auto target = random_path(50, 5), predicted = target;
  predicted[77] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(score(predicted, cases_of(target, 1, 50), metres_times(1.0f)), std::runtime_error);
}

TEST(RandomBaseline, IsAPathOfAnotherClipAndDependsOnItsSeed) {
  const int count = 20, steps = 3;
  const auto cases = cases_of(random_path(count * steps, 9), count, steps);
  const auto paths = random_paths(cases, 4);
  EXPECT_EQ(paths, random_paths(cases, 4));
  EXPECT_NE(paths, random_paths(cases, 5));
  const std::size_t size = cases.path_size();
  for (int i = 0; i < count; ++i) {
    const auto first = paths.begin() + static_cast<std::ptrdiff_t>(i * size);
    const std::vector<float> path(first, first + static_cast<std::ptrdiff_t>(size));
    for (int j = 0; j < count; ++j) {
      const auto other = cases.batch.target.begin() + static_cast<std::ptrdiff_t>(j * size);
      EXPECT_FALSE(cases.sequence[j] == cases.sequence[i] &&
                   std::equal(path.begin(), path.end(), other));
    }
  }
}

TEST(Bootstrap, IntervalContainsTheMeanAndShrinksWithTheNumberOfClips) {
  RandomStream random(3, "differences");
  const auto width = [&](int clips) {
    std::vector<double> a, b;
    std::vector<int> clip;
    for (int i = 0; i < clips * 5; ++i) {
      a.push_back(random.normal(-0.1, 0.05));
      b.push_back(0.0);
      clip.push_back(i / 5);
    }
    const Difference found = bootstrap_difference(a, b, clip, 1);
    EXPECT_LE(found.low, found.mean);
    EXPECT_GE(found.high, found.mean);
    EXPECT_LT(found.high, 0.0);
    return found.high - found.low;
  };
  // Standard error 0.05 / sqrt(5 clips): 1.96 of it to either side, within a third.
  EXPECT_NEAR(width(100), 2 * 1.96 * 0.05 / std::sqrt(500.0),
              0.3 * 2 * 1.96 * 0.05 / std::sqrt(500.0));
  EXPECT_GT(width(10), width(1000));
}

TEST(Bootstrap, SamplesWholeClips) {
  // Roll-outs of a clip are copies of one number: the interval must be that of the clips, not of
  // the copies.
  RandomStream random(4, "clips");
  std::vector<double> a, b;
  std::vector<int> clip;
  for (int c = 0; c < 50; ++c) {
    const double value = random.normal();
    for (int i = 0; i < 100; ++i) a.push_back(value), b.push_back(0.0), clip.push_back(c);
  }
  const Difference found = bootstrap_difference(a, b, clip, 1);
  EXPECT_GT(found.high - found.low, 2 * 1.96 / std::sqrt(50.0) * 0.6);
}

}  // namespace
