// Coverage of bands with known coverage, and band scaling.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/dataset/dataset.h"
#include "pipeline/study/band.h"
#include "pipeline/study/model_card.h"
#include "pipeline/study/rollouts.h"

namespace {

using namespace touchtrace;
using namespace touchtrace::study;

struct Residuals {
  RolloutBatch batch;
  Rollout rollout;
};

/// Normal residuals whose standard deviation grows with the step, and a band of constant half
/// width: the 90 % quantile of the first step.
Residuals growing_residuals(int sequences, int steps, std::uint64_t seed) {
  RandomStream random(seed, "residuals");
  Residuals made;
  made.batch.sequences = sequences;
  made.batch.steps = steps;
  for (int i = 0; i < sequences * steps * state_size; ++i) {
    const int step = i / state_size % steps;
    made.batch.target.push_back(static_cast<float>(random.normal(0.0, 1.0 + step)));
  }
  made.rollout.state.assign(made.batch.target.size(), 0.0f);
  made.rollout.spread.assign(made.batch.target.size(), 1.2815516f);
  return made;
}

/// Upper limit of five standard errors of a fraction of n values.
double five_sigma(int n) { return 5.0 * std::sqrt(0.5 * 0.5 / n); }

TEST(BestEntry, IsTheLastOneIfValidationIsUndefined) {
  const auto with_l1 = [](int update, double l1) {
    TrainingLogEntry entry;
    entry.update = update, entry.validation_l1_at_50 = l1;
    return entry;
  };
  const double undefined = std::nan("");
  EXPECT_EQ(best_entry({with_l1(5, undefined), with_l1(10, undefined)}).update, 10);
  EXPECT_EQ(best_entry({with_l1(5, undefined), with_l1(10, 0.4), with_l1(15, 0.4)}).update, 10);
  EXPECT_EQ(best_entry({with_l1(5, 0.3), with_l1(10, undefined)}).update, 5);
}

TEST(Band, CoverageOfAKnownBand) {
  const int sequences = 400, steps = 3;
  const auto made = growing_residuals(sequences, steps, 1);
  const auto coverage = coverage_by_step(made.rollout, made.batch, {});
  for (int step = 0; step < steps; ++step)
    EXPECT_NEAR(coverage[step], std::erf(1.2815516 / (1.0 + step) / std::sqrt(2.0)),
                five_sigma(sequences * state_size));
}

class BandScaling : public ::testing::TestWithParam<double> {};

TEST_P(BandScaling, ReachesTheNominalCoverageOnNewResiduals) {
  const int sequences = 400, steps = 10;
  const double nominal = nominal_coverage(GetParam());
  const auto fitted = growing_residuals(sequences, steps, 1),
             fresh = growing_residuals(sequences, steps, 2);
  const BandScale scale = fit_band_scale(fitted.rollout, fitted.batch, nominal);
  const auto coverage = coverage_by_step(fresh.rollout, fresh.batch, scale);
  for (int step = 0; step < steps; ++step) {
    // fraction of normal residuals within factor x spread
    EXPECT_NEAR(std::erf(scale[step] * 1.2815516 / (1.0 + step) / std::sqrt(2.0)), nominal,
                five_sigma(sequences * state_size));
    // fit and check both have the error of a fraction
    EXPECT_NEAR(coverage[step], nominal, std::sqrt(2.0) * five_sigma(sequences * state_size));
  }
}

INSTANTIATE_TEST_SUITE_P(Quantiles, BandScaling, ::testing::Values(0.1, 0.02, 0.25, 0.4));

TEST(Band, IgnoresStepsWithoutWeight) {
  auto made = growing_residuals(2, 2, 1);
  made.batch.weight = {1, 0, 1, 0};
  const auto coverage = coverage_by_step(made.rollout, made.batch, {});
  EXPECT_FALSE(std::isnan(coverage[0]));
  EXPECT_TRUE(std::isnan(coverage[1]));
  EXPECT_EQ(fit_band_scale(made.rollout, made.batch, 0.8)[1], 1.0);
}

TEST(Band, LastFactorAppliesToLaterSteps) {
  const auto made = growing_residuals(5, 4, 1);
  const auto scaled = with_scaled_band(made.rollout, 4, {2.0, 3.0});
  EXPECT_FLOAT_EQ(scaled.spread[0], 2.0f * 1.2815516f);
  EXPECT_FLOAT_EQ(scaled.spread[state_size], 3.0f * 1.2815516f);
  EXPECT_FLOAT_EQ(scaled.spread[3 * state_size], 3.0f * 1.2815516f);
  EXPECT_FLOAT_EQ(scaled.spread[4 * state_size], 2.0f * 1.2815516f);
}

TEST(Band, MeanLossMatchesEquation4) {
  RolloutBatch batch{1, 1, {0}, {}, std::vector<float>(state_size, 1.0f), {}};
  const Rollout rollout{std::vector<float>(state_size, 0.0f), std::vector<float>(state_size, 0.5f)};
  // |1 - 0| + 0.1 (1 + 0.5) + 0.9 (1 - 0.5)
  EXPECT_NEAR(mean_loss(rollout, batch, 0.1), (1.0 + 0.15 + 0.45), 1e-6);
  // |1 - 0| + 0.25 (1 + 0.5) + 0.75 (1 - 0.5)
  EXPECT_NEAR(mean_loss(rollout, batch, 0.25), (1.0 + 0.375 + 0.375), 1e-6);
  batch.weight = {0.0f};
  EXPECT_TRUE(std::isnan(mean_loss(rollout, batch, 0.1)));
}

TEST(Band, FactorsArePositiveWithoutErrors) {
  auto made = growing_residuals(2, 2, 1);
  made.rollout.state = made.batch.target;
  EXPECT_EQ(fit_band_scale(made.rollout, made.batch, 0.8), BandScale(2, min_scale));
  EXPECT_TRUE(is_finite(made.rollout));
  made.rollout.spread.back() = NAN;
  EXPECT_FALSE(is_finite(made.rollout));
}

}  // namespace
