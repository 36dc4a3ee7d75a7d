#pragma once

#include <vector>

#include "engine/train/trainer.h"

namespace touchtrace::study {

/// The band of a roll-out knows the step but not how far it is from the start, so its coverage
/// falls with the horizon. One factor a step, fitted on validation clips by split-conformal
/// prediction (Papadopoulos 2002; Lei 2018), widens it to its nominal level.
using BandScale = std::vector<double>;

/// Between the quantiles Q and 1 - Q lies this share (equation 3).
constexpr double nominal_coverage(double band_quantile) { return 1.0 - 2.0 * band_quantile; }
/// Narrower bands count as this wide (scaled units): a band of no width has no scale.
inline constexpr double narrowest_spread = 1e-6;

/// factor[k] is the ceil(coverage (n + 1))-th smallest |target - state| / spread among the n
/// trusted values of step k + 1, all 12 dimensions and roll-outs together. Steps without a value
/// keep 1.
BandScale fit_band_scale(const Rollout& rollout, const RolloutBatch& batch, double coverage);

/// Share of trusted targets inside state -/+ scale spread, per step: [steps]; NaN where none is
/// trusted. An empty scale is 1; steps beyond its end use its last factor.
std::vector<double> coverage_by_step(const Rollout& rollout, const RolloutBatch& batch,
                                     const BandScale& scale);

/// The rollout with its spread multiplied.
Rollout with_scaled_band(Rollout rollout, int steps, const BandScale& scale);

}  // namespace touchtrace::study
