#pragma once

#include <vector>

#include "engine/train/trainer.h"

namespace touchtrace::study {

/// [steps] Factors of the predicted half band width. The model predicts a width without knowing the
/// number of steps since the start, so coverage falls with the horizon. One factor per step, fitted
/// on validation clips by split conformal prediction (Papadopoulos 2002; Lei 2018), restores the
/// nominal coverage.
using BandScale = std::vector<double>;

/// Fraction of states between the quantiles Q and 1 - Q (equation 3).
constexpr double nominal_coverage(double band_quantile) { return 1.0 - 2.0 * band_quantile; }
/// Lower limit of the half band width [scaled units], as a width of 0 cannot be scaled.
inline constexpr double min_spread = 1e-6;

/// Lower limit of a factor, as a band of width 0 cannot be scaled back.
inline constexpr double min_scale = 1e-6;

/// Fits the factors to finite predictions: factor[k] is the ceil(coverage (n + 1))-th smallest
/// |target - state| / spread of the n trusted values of step k + 1, over all 12 dimensions and
/// roll-outs; 1 for steps without any.
BandScale fit_band_scale(const Rollout& rollout, const RolloutBatch& batch, double coverage);

/// [steps] Fraction of trusted targets inside state -/+ scale * spread; NaN for steps without any.
/// An empty scale means 1; steps beyond its end use its last factor.
std::vector<double> coverage_by_step(const Rollout& rollout, const RolloutBatch& batch,
                                     const BandScale& scale);

/// Spread of step `step`, counted from 0, after scaling. Steps beyond the end of the scale use its
/// last factor.
float scaled_spread(const BandScale& scale, int step, float spread);

/// Returns the roll-out with scaled spreads.
Rollout with_scaled_band(Rollout rollout, int steps, const BandScale& scale);

}  // namespace touchtrace::study
