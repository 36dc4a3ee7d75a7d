#pragma once

#include <optional>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// E[w r^2] E[1 / w] / 3 of the weights w of find_weights at normal residuals r: with it the
/// variances that the weights leave are on average those of the measurements.
constexpr double robust_share = 0.923;

/// The linear pass over a track with its weights, flights and jerk as they are.
Trajectory pass(const WeightedTrack& track, const MotionNoise<double>& noise,
                const SmoothOptions& options);

/// Cauchy's loss c^2 log(1 + r^2 / c^2) of the square r^2 of a whitened distance, with c = 4.
double cauchy_loss(double square);

/// Sets the weights to those of Cauchy's loss at the residuals of `trajectory`; returns the largest
/// change.
double reweight(WeightedTrack& track, const Trajectory& trajectory);

/// Gauss-Newton on the robust loss: least squares with new weights until they stay. False if they
/// do not.
bool find_weights(WeightedTrack& track, const MotionNoise<double>& noise,
                  const SmoothOptions& options);

/// Of find_jerk: a few tell one share from another and mend a course that was found.
inline constexpr int few_rounds = 6, enough_rounds = 12;

/// Finds how freely a body moves from point to point, and in which direction: the `jerk` of every
/// track, with the weights and the measurement scale that belong to it, by expectation and
/// maximisation. What is expected of each jerk is averaged with its neighbours', in a Gaussian
/// window, and with a share of the mean of all, which keeps rest from being absolute.
void find_jerk(std::vector<WeightedTrack>& tracks, MotionNoise<double>& noise,
               const SmoothOptions& options, int rounds);

/// The share of the mean jerk that the course of the jerk is best held to; nothing if one density
/// for all is better. The course is judged by measurements that it was not found from (to those
/// that it was, it always fits better), and of those that do as well as the best but for a standard
/// error, the least changing one is the best (Breiman et al., Classification and Regression Trees,
/// 1984).
std::optional<double> best_jerk_share(const std::vector<WeightedTrack>& tracks,
                                      const MotionNoise<double>& constant,
                                      const SmoothOptions& options);

}  // namespace touchtrace
