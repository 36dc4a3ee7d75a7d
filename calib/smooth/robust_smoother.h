#pragma once

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// E[w r^2] E[1 / w] / 3 for the weights w of `estimate_weights` at normally distributed residuals
/// r. Dividing variances by it makes their mean, weights included, that of the measurements.
constexpr double robust_variance_ratio = 0.923;

/// Linear filter and smoother pass with the track's current weights, flights and process noise
/// curve.
Trajectory smooth_once(const WeightedTrack& track, const MotionNoise& noise,
                       const SmoothOptions& options);

/// Cauchy loss c^2 log(1 + r^2 / c^2) of a squared whitened residual r^2, with c = 4.
double cauchy_loss(double squared_residual);

/// Weight of a measurement that is right or wrong: 1 or nearly none.
double weight_of(Judgement judgement);

/// Sets the weights to those of the Cauchy loss at `trajectory`'s residuals, but of measurements
/// with a judgement to its own. Returns the largest change.
double reweight(WeightedTrack& track, const Trajectory& trajectory);

/// Minimises the robust loss by iteratively reweighted least squares. Returns whether the weights
/// converged to 1e-4.
bool estimate_weights(WeightedTrack& track, const MotionNoise& noise, const SmoothOptions& options);

}  // namespace touchtrace
