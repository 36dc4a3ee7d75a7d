#pragma once

#include <optional>
#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Iterations of estimate_jerk_covariances: enough to compare settings or to update an estimate;
/// enough to converge.
inline constexpr int few_iterations = 6, enough_iterations = 12;

/// Estimates time-varying process noise by expectation maximisation: the jerk covariance before
/// each point of each track, with the matching weights and measurement scale. The M step averages
/// each expected covariance with its neighbours in a Gaussian window and with a prior,
/// `noise.prior_jerk_fraction` of the mean over all tracks, which keeps rest from being exact.
void estimate_jerk_covariances(std::vector<WeightedTrack>& tracks, MotionNoise<double>& noise,
                               const SmoothOptions& options, int num_iterations);

/// Selects MotionNoise::prior_jerk_fraction from 0.3 and 0.1, or nullopt if constant process noise
/// is better. Every fourth measurement is held out and scored by its negative log-likelihood. Among
/// the settings within one standard error of the best, the one with the least variation wins
/// (one-standard-error rule; Breiman et al., Classification and Regression Trees, 1984).
std::optional<double> select_prior_jerk_fraction(const std::vector<WeightedTrack>& tracks,
                                                 const MotionNoise<double>& constant_noise,
                                                 const SmoothOptions& options);

}  // namespace touchtrace
