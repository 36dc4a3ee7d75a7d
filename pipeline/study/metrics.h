#pragma once

#include <span>
#include <vector>

#include "pipeline/dataset/dataset.h"

namespace touchtrace::study {

/// Steps over which roll-outs are evaluated: L1@50 and L1@20 (Table II).
inline constexpr int horizon_steps = 50, short_horizon_steps = 20;

/// [steps, 12] States of one roll-out at steps 1, 2, ...; finite, normalised unless in metres.
/// Compared paths have the same length.
using Path = std::span<const float>;

/// [steps] |predicted - target|, mean over the 12 dimensions.
std::vector<double> l1_by_step(Path predicted, Path target);

/// Hausdorff distance of two paths as sets of states (section III-D), with the Euclidean distance
/// of normalised 12-dimensional states.
double hausdorff(Path a, Path b);

/// [steps] Distance [m] of the positions at dimensions `first` .. `first` + 2 of unscaled states.
std::vector<double> distance_by_step(Path predicted_m, Path target_m, int first);

/// Weighted mean of the first `steps` values; NaN if all their weights are 0.
double mean_until(std::span<const double> by_step, std::span<const float> weight, int steps);

}  // namespace touchtrace::study
