#pragma once

#include <span>
#include <vector>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Steps that a roll-out is held against the target; the metrics name steps 20 and 50 (Table II).
inline constexpr int horizon_steps = 50, short_horizon_steps = 20;

/// States of one roll-out, steps 1, 2, ...: [steps, 12], finite. Scaled, except where metres are
/// asked for. Two paths that are compared have the same length.
using Path = std::span<const float>;

/// |predicted - target| of each step, mean over the 12 dimensions: [steps].
std::vector<double> l1_by_step(Path predicted, Path target);

/// Largest distance from a state of one path to the nearest state of the other, in either direction
/// (section III-D); d is the Euclidean distance of scaled states.
double hausdorff(Path a, Path b);

/// Distance of the positions [m] that start at dimension `first` of unscaled states: [steps].
std::vector<double> distance_by_step(Path predicted_m, Path target_m, int first);

/// Weighted mean of the first `steps` values; NaN if their weights are all 0.
double mean_until(std::span<const double> by_step, std::span<const float> weight, int steps);

}  // namespace touchtrace::study
